#include "workstation/runs/run/run_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <fstream>

#include "shared/crc32.h"
#include "shared/host/embed/build_info.h"
#include "shared/host/file.h"
#include "shared/host/json_reader.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/training_period.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {

namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "a run manifest; repeat the run in another folder";

Entries::const_iterator find(const Entries& entries, const std::string& name) {
  return std::ranges::find(entries, name, &Entries::value_type::first);
}

Entries entries_of(const JsonValue& object, const RunFolder& folder) {
  Entries entries;
  for (const JsonValue member : object) {
    if (member.text() == nullptr) {
      fail("{}: not {}: \"{}\" is not a text", folder.record().string(), kKind, member.key());
    }
    entries.emplace_back(member.key(), member.text());
  }
  return entries;
}

StageRecord stage_of(const JsonValue& json, const RunFolder& folder) {
  return {std::string(json.key()), entries_of(json["inputs"], folder),
          entries_of(json["outputs"], folder), json["failed"].boolean().value_or(false)};
}

constexpr const char* kPricesKey = "prices";  // as in run.json

/// Adds keys that `there` lacks, with their default: older files did not have them.
Entries with_defaults(Entries there, const Entries& here) {
  const Entries defaults = circumstances_of(config_entries(RunConfig{}));
  for (const auto& entry : here) {
    const bool known =
        std::ranges::find(there, entry.first, &Entries::value_type::first) != there.end();
    if (!known && std::ranges::find(defaults, entry) != defaults.end()) there.push_back(entry);
  }
  return there;
}

/// Price regimes of `days` without training days, in a sentence; empty when none, or unknown.
std::string unknown_regimes(const Entries& there, const MarketSteps& market,
                            const std::vector<MarketDay>& days) {
  const auto learnt = learnt_span(there);
  if (!learnt || days.empty()) return {};
  const std::string regimes = regimes_not_learnt(*learnt, market.span_of(days));
  if (regimes.empty()) return {};
  return fmt::format(
      "trained on prices of {} to {}, but these days are in another price regime: {}",
      local_date_text(learnt->from_s).view(), local_date_text(learnt->until_s - 1).view(), regimes);
}

}  // namespace

void add_figures(const RunFigures& figures, Json& json) {
  json.set("provenance", figures.provenance);
  json.set("weights_hash", figures.weights_hash);
  json.set("states_checked", figures.states_checked);
  json.set("states_checked_plain", figures.states_checked_plain);
  json.set("violations_plain", figures.violations_plain);
  json.set("violations_corrected", figures.violations_corrected);
  json.set("demands", Json::list_from(figures.demands, [](const DemandFigures& d) {
             return Json::object({{"demand", d.demand},
                                  {"violations_plain", d.violations_plain},
                                  {"violations_corrected", d.violations_corrected}});
           }));
}

std::string file_mark(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || !fs::is_regular_file(path)) return {};
  Crc32 crc;
  std::uint64_t bytes = 0;
  std::array<char, 1 << 16> part;
  while (file.read(part.data(), part.size()) || file.gcount() > 0) {
    crc.add_bytes(part.data(), static_cast<std::size_t>(file.gcount()));
    bytes += static_cast<std::uint64_t>(file.gcount());
  }
  return fmt::format("crc32 {:08x}, {} bytes", crc.value(), bytes);
}

Entries marks_of(const std::vector<std::string>& names, const RunFolder& folder) {
  Entries marks;
  for (const std::string& name : names) marks.emplace_back(name, file_mark(folder.path / name));
  return marks;
}

RunConfig RunRecord::config(const RunFolder& folder) const {
  std::string toml;
  std::string section;
  for (const auto& [name, value] : identity) {
    if (!name.starts_with('[')) continue;  // not a configuration key
    const std::size_t end = name.find(']') + 1;
    if (name.substr(0, end) != section) toml += (section = name.substr(0, end)) + "\n";
    toml += fmt::format("{} = {}\n", name.substr(end + 1), value);
  }
  RunConfig config = parse_run_config(toml, folder.record().string());
  config.set_seed(std::strtoull(value("seed").c_str(), nullptr, 10));
  config.set_threads(
      std::max(1, static_cast<int>(std::strtol(value("threads").c_str(), nullptr, 10))));
  if (const std::string rules = value(kRulesKey); !rules.empty()) {
    config.distil.rules = parse_rules(rules, folder.record().string() + ": rules");
  }
  return config;
}

const StageRecord* RunRecord::holds(const std::string& stage,
                                    const std::vector<std::string>& inputs,
                                    const RunFolder& folder) const {
  const auto found = std::ranges::find(stages, stage, &StageRecord::name);
  if (found == stages.end() || found->inputs != marks_of(inputs, folder)) return nullptr;
  const bool is_whole = std::ranges::all_of(found->outputs, [&](const auto& output) {
    return file_mark(folder.path / output.first) == output.second;
  });
  return is_whole ? &*found : nullptr;
}

std::string RunRecord::state() const {
  if (figures) return "finished";
  if (stages.empty()) return "started";
  return has_failed() ? "ended without a proof"
                      : fmt::format("stopped after the {}", stages.back().name);
}

bool RunRecord::has_failed() const { return std::ranges::any_of(stages, &StageRecord::failed); }

Entries identity_of(const RunConfig& config, const std::string& prices_hash,
                    const std::string& teacher_hash) {
  Entries identity{{"bess-train", BESS_VERSION},
                   {"prices", prices_hash},
                   {"seed", fmt::format("{}", config.train.seed)},
                   {"threads", fmt::format("{}", config.train.threads)},
                   {"teacher", teacher_hash.empty() ? "of this run" : teacher_hash}};
  for (auto& entry : config_entries(config)) identity.push_back(std::move(entry));
  const RuleSet& rules = config.distil.rules;
  if (!rules.empty()) identity.emplace_back(kRulesKey, format_rules(rules));
  return identity;
}

Entries configuration_of(const Entries& identity) {
  Entries kept = identity;
  std::erase_if(kept, [](const auto& entry) { return !entry.first.starts_with('['); });
  return kept;
}

Entries circumstances_of(const Entries& identity) {
  Entries kept = identity;
  std::erase_if(kept, [](const auto& entry) {
    return !entry.first.starts_with("[market]") && !entry.first.starts_with("[battery]") &&
           !entry.first.starts_with("[costs]");
  });
  return kept;
}

std::string differences(const Entries& there, const Entries& here, const std::string& where_there,
                        const std::string& where_here) {
  std::string text;
  const auto add = [&](const std::string& name, const std::string& a, const std::string& b) {
    text += fmt::format("{}{} is {} {} and {} {}", text.empty() ? "" : "; ", name, one_line(a),
                        where_there, one_line(b), where_here);
  };
  for (const auto& [name, value] : there) {
    const auto found = find(here, name);
    if (found == here.end()) add(name, value, "unknown");
    if (found != here.end() && found->second != value) add(name, value, found->second);
  }
  for (const auto& [name, value] : here) {
    if (find(there, name) == there.end()) add(name, "unknown", value);
  }
  return text;
}

std::optional<RunRecord> load_run_record(const RunFolder& folder) {
  const std::string name = folder.record().string();
  if (!fs::exists(name)) return std::nullopt;
  const Json json = Json::parse(read_file(name));
  const JsonReader reader(json.value(), name, kKind);
  (void)reader.object("identity");  // missing in files of other versions
  RunRecord record;
  record.prices = reader.text("prices");
  record.prices_name = reader.text("prices_name");
  if (const char* file = json.value()["teacher_file"].text()) record.teacher_file = file;
  record.commit = json.value()["commit"].text_or("");
  record.day_ahead = json.value()["day_ahead"].text_or("");
  record.identity = entries_of(json.value()["identity"], folder);
  for (const JsonValue stage : json.value()["stages"]) {
    record.stages.push_back(stage_of(stage, folder));
  }
  if (json.value()["figures"].is_object()) {
    const JsonReader figures = reader.object("figures");
    const auto count = [](const JsonReader& in, const char* key) {
      return in.whole(key, 0, std::int64_t{1} << 52);
    };
    record.figures = {figures.text("provenance"),         figures.text("weights_hash"),
                      count(figures, "states_checked"),   count(figures, "states_checked_plain"),
                      count(figures, "violations_plain"), count(figures, "violations_corrected")};
    record.figures->last_learnt_day = json.value()["figures"]["last_learnt_day"].text_or("");
    for (const JsonValue demand : json.value()["figures"]["demands"]) {
      const JsonReader of(demand, name, kKind);
      record.figures->demands.push_back(
          {of.text("demand"), count(of, "violations_plain"), count(of, "violations_corrected")});
    }
  }
  return record;
}

RunRecord existing_run_record(const RunFolder& folder) {
  std::optional<RunRecord> record = load_run_record(folder);
  if (record) return std::move(*record);
  fail("{}: no run here ({} is missing); create one with 'bess-train run --out {}'",
       folder.path.string(), run_file::kRecord, folder.path.string());
}

void save_run_record(const RunFolder& folder, const RunRecord& record) {
  Json json = Json::object({{"prices", record.prices}, {"prices_name", record.prices_name}});
  if (!record.teacher_file.empty()) json.set("teacher_file", record.teacher_file);
  if (!record.day_ahead.empty()) json.set("day_ahead", record.day_ahead);
  json.set("commit", std::string(build_commit()));
  json.set("identity", json_of(record.identity));
  Json stages = Json::object();
  for (const StageRecord& stage : record.stages) {
    Json one =
        Json::object({{"inputs", json_of(stage.inputs)}, {"outputs", json_of(stage.outputs)}});
    if (stage.failed) one.set("failed", true);
    stages.set(stage.name.c_str(), std::move(one));
  }
  json.set("stages", std::move(stages));
  if (record.figures) {
    Json figures = Json::object();
    add_figures(*record.figures, figures);
    figures.set("last_learnt_day", record.figures->last_learnt_day);
    json.set("figures", std::move(figures));
  }
  write_file(folder.record(), json.text());
}

Entries learnt_for(const RunConfig& config, const std::string& prices) {
  Entries entries = circumstances_of(config_entries(config));
  entries.emplace_back(kPricesKey, prices);
  return entries;
}

Entries learnt_for_of(const std::filesystem::path& model) {
  if (!std::filesystem::is_regular_file(model)) return {};
  Entries own =
      is_teacher_file(model) ? load_teacher(model).learnt_for : load_student(model).learnt_for;
  if (!own.empty()) return own;
  const auto run = load_run_record({model.parent_path()});
  if (!run) return {};
  Entries of_run = circumstances_of(run->identity);
  of_run.emplace_back(kPricesKey, run->value(kPricesKey));
  return of_run;
}

std::string learnt_otherwise(const Entries& there, const Entries& here) {
  if (there.empty()) return {};
  Entries of_both = there;
  std::erase_if(of_both, [&](const auto& entry) {
    return std::ranges::find(here, entry.first, &Entries::value_type::first) == here.end();
  });
  return differences(with_defaults(std::move(of_both), here), here);
}

std::string old_prices(const MinuteSeries& series, std::int64_t now_utc_s) {
  const auto date = [](std::int64_t utc_s) { return local_date_text(utc_s); };
  const auto newest = date(series.utc_s(series.size()) - 1);
  const auto age = training_age_text({newest.view(), newest.view()}, date(now_utc_s).view());
  if (age.empty()) return {};
  return fmt::format(
      "the newest day of these prices, {}, was {}; for newer prices: bess-train prices fetch "
      "--from {} --to {} --out FILE, then run --prices FILE",
      newest.view(), age.view(), date(now_utc_s - 365 * kSecondsPerDay).view(),
      date(now_utc_s - kSecondsPerDay).view());
}

void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here,
                           const MarketSteps& market, const std::vector<MarketDay>& days) {
  const Entries there = learnt_for_of(model);
  std::string other = learnt_otherwise(there, here);
  const std::string regimes = unknown_regimes(there, market, days);
  if (!regimes.empty()) other += (other.empty() ? "" : "; ") + regimes;
  if (other.empty()) return;
  fmt::print(stderr, "bess-train: warning: {} was trained for other conditions: {}\n",
             model.string(), other);
}

void warn_unknown_regimes(const std::string& what, const MarketSteps& fitting,
                          const MarketSteps& market, const std::vector<MarketDay>& days) {
  const std::vector<MarketDay> fitted = fitting.fitted_days();
  if (fitted.empty() || days.empty()) return;
  const std::string regimes = regimes_not_learnt(fitting.span_of(fitted), market.span_of(days));
  if (regimes.empty()) return;
  fmt::print(stderr,
             "bess-train: warning: {}: trained on {} to {}, but traded in a price regime without "
             "training days: {}\n",
             what, fitted.front().date(), fitted.back().date(), regimes);
}

}  // namespace bess
