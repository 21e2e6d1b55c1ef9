#include "workstation/sweep/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <unordered_set>

#include "shared/crc32.h"
#include "shared/host/distinct_files.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/json_reader.h"
#include "shared/host/made/build_info.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/chain/chain_steps.h"
#include "workstation/chain/config_plausibility.h"
#include "workstation/chain/rule_files.h"
#include "workstation/rules/rule_file.h"
#include "workstation/run/run_fold.h"
#include "workstation/run/run_record.h"
#include "workstation/run/run_report.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr const char* kKind = "a sweep's record; plan the sweep again in another folder";
/// More would not fit the six digits of a folder's name.
constexpr std::size_t kTasksMax = 999'999;

/// A plan's file with the command line's options on top.
struct PlanText {
  std::string config;
  std::vector<std::string> rules;
  std::string sites;
  std::vector<std::uint64_t> seeds{1};
  bool by_month = false;
  bool is_full = false;
  double rate_step_percent = 0;  ///< of rounded C-rates
  Axes axes;
};

[[noreturn]] void complain_of_plan(const TomlValue& value, const std::string& what) {
  fail("{}:{}: {}", *value.file, value.line, what);
}

const std::string& text_of(const TomlValue& value, const std::string& key) {
  const auto* text = value.as<std::string>();
  if (text == nullptr)
    complain_of_plan(value, fmt::format("[sweep] {}: expected a text in quotes", key));
  return *text;
}

std::vector<std::uint64_t> first_seeds(int count) {
  std::vector<std::uint64_t> seeds;
  for (int s = 1; s <= count; ++s) seeds.push_back(static_cast<std::uint64_t>(s));
  return seeds;
}

std::vector<std::uint64_t> read_seeds(const TomlValue& value) {
  const auto whole = [&](const TomlValue& one, std::int64_t low, std::int64_t high) {
    const auto* number = one.as<std::int64_t>();
    if (number == nullptr || *number < low || *number > high) {
      complain_of_plan(one, "[sweep] seeds: write how many, 1 to 10000, or a list of them");
    }
    return *number;
  };
  const auto* list = value.as<TomlArray>();
  if (list == nullptr) return first_seeds(static_cast<int>(whole(value, 1, 10'000)));
  std::vector<std::uint64_t> seeds;
  for (const TomlValue& one : *list) {
    seeds.push_back(static_cast<std::uint64_t>(whole(one, 0, INT64_MAX)));
    if (std::ranges::count(seeds, seeds.back()) > 1)
      complain_of_plan(one, "this seed stands there twice");
  }
  if (seeds.empty()) complain_of_plan(value, "[sweep] seeds: the list is empty");
  return seeds;
}

void read_sweep_section(const TomlValue& table, const fs::path& beside, PlanText& plan) {
  const auto* members = table.as<TomlMembers>();
  if (members == nullptr) complain_of_plan(table, "[sweep] is a section: write its keys below");
  for (const auto& [key, value] : *members) {
    if (key == "config") {
      plan.config = (beside / text_of(value, key)).string();
    } else if (key == "sites") {
      plan.sites = (beside / text_of(value, key)).string();
    } else if (key == "folds") {
      if (text_of(value, key) != "monthly")
        complain_of_plan(value, "[sweep] folds: \"monthly\" or absent");
      plan.by_month = true;
    } else if (key == "seeds") {
      plan.seeds = read_seeds(value);
    } else if (key == "full") {
      if (value.as<bool>() == nullptr)
        complain_of_plan(value, "[sweep] full: expected true or false");
      plan.is_full = *value.as<bool>();
    } else if (key == "c_rate_step_percent") {
      plan.rate_step_percent = value.number().value_or(-1);
      if (plan.rate_step_percent < 0 || plan.rate_step_percent > 20)
        complain_of_plan(value, "[sweep] c_rate_step_percent: expected a number from 0 to 20");
    } else if (key == "rules") {
      const auto* list = value.as<TomlArray>();
      if (list == nullptr) complain_of_plan(value, "[sweep] rules: expected a list of files");
      for (const TomlValue& file : *list) {
        plan.rules.push_back((beside / text_of(file, key)).string());
      }
    } else {
      complain_of_plan(
          value, fmt::format("unknown key \"{}\" in [sweep]: use config, rules, sites, seeds, "
                             "folds, full or c_rate_step_percent",
                             one_line(key, 40)));
    }
  }
}

PlanText read_plan(const SweepRequest& request) {
  PlanText plan;
  if (!request.plan.empty()) {
    TomlValue document;
    std::string error;
    if (!parse_toml_text(read_file(request.plan, kTomlBytesMax), request.plan, document, error)) {
      throw UserError(error);
    }
    for (const auto& [section, value] : *document.as<TomlMembers>()) {
      if (section == "sweep") {
        read_sweep_section(value, fs::path(request.plan).parent_path(), plan);
      } else if (section == "grid") {
        plan.axes.grid = read_grid(value);
      } else if (section == "list") {
        plan.axes.list = read_list(value);
      } else if (section == "random") {
        read_random(value, plan.axes);
      } else {
        complain_of_plan(value,
                         fmt::format("unknown section \"{}\": a plan has [sweep], [grid], [[list]] "
                                     "and [random]",
                                     one_line(section, 40)));
      }
    }
  }
  for (const std::string& set : request.sets) plan.axes.grid.push_back(read_set_option(set));
  if (request.seeds > 0) plan.seeds = first_seeds(request.seeds);
  if (!request.folds.empty()) plan.by_month = true;
  if (!request.config.empty()) plan.config = request.config;
  if (!request.sites.empty()) plan.sites = request.sites;
  plan.is_full = plan.is_full || request.full;
  return plan;
}

std::string crc_text(std::string_view text) {
  Crc32 crc;
  crc.add_bytes(text.data(), text.size());
  return fmt::format("{:08x}", crc.value());
}

/// A rule file of the sweep, by its content.
std::string keep_rules(SweepPlan& plan, const std::string& text) {
  const std::string stem = crc_text(text);
  const auto found =
      std::ranges::find(plan.rules, stem, &std::pair<std::string, std::string>::first);
  if (found == plan.rules.end()) plan.rules.emplace_back(stem, text);
  return stem;
}

/// "section.key" of "[section] key".
std::string dotted(const std::string& listed) {
  const std::size_t end = listed.find(']');
  return listed.substr(1, end - 1) + "." + listed.substr(end + 2);
}

/// What sets a class of sites apart from the sweep's configuration.
Entries class_settings(const SiteClass& one, const RunConfig& base, SweepPlan& plan) {
  Entries settings;
  if (!one.rules.empty()) settings.emplace_back(setting::kRules, keep_rules(plan, one.rules));
  settings.emplace_back(setting::kClass, one.name);
  const Entries here = config_entries(one.config);
  const Entries there = config_entries(base);
  for (std::size_t k = 0; k < here.size(); ++k) {
    if (here[k].second != there[k].second) {
      settings.emplace_back(dotted(here[k].first), here[k].second);
    }
  }
  return settings;
}

/// Each class, or once what the plan's own rules set.
std::vector<Entries> class_axis(const PlanText& text, SweepPlan& plan) {
  const RuleSet rules = load_rules(text.rules);
  if (text.sites.empty()) {
    Entries settings;
    if (!rules.empty())
      settings.emplace_back(setting::kRules, keep_rules(plan, format_rules(rules)));
    return {settings};
  }
  if (!rules.empty()) fail("{}: with sites, the rules stand in their column \"rules\"", text.sites);
  Sites sites = read_sites(text.sites, plan.base, text.rate_step_percent);
  std::vector<Entries> axis;
  for (const SiteClass& one : sites.classes) axis.push_back(class_settings(one, plan.base, plan));
  plan.sites = std::move(sites.sites);
  plan.classes = sites.classes.size();
  return axis;
}

std::vector<std::string> fold_axis(const PlanText& text, const MarketSteps& market) {
  return text.by_month ? fold_months(market) : std::vector<std::string>{""};
}

/// A key that a class of sites sets already is no axis beside it.
void require_apart(const std::vector<Entries>& points, const std::vector<Entries>& classes) {
  for (const auto& [key, value] : points.front()) {
    for (const Entries& settings : classes) {
      if (std::ranges::find(settings, key, &Entries::value_type::first) == settings.end()) continue;
      fail("{}: the sites set it, and an axis does too; leave it to one of them", key);
    }
  }
}

/// The number of all of them is known before the first is made.
std::vector<Entries> combinations(const PlanText& text, const std::vector<Entries>& classes,
                                  const std::vector<std::string>& folds) {
  const std::vector<Entries> points = points_of(text.axes);
  require_apart(points, classes);
  const std::size_t count = points.size() * classes.size() * folds.size() * text.seeds.size();
  if (count > kTasksMax) fail("the plan has {} tasks; {} is the most", count, kTasksMax);
  std::vector<Entries> all;
  all.reserve(count);
  for (const std::uint64_t seed : text.seeds) {
    for (const Entries& one : classes) {
      for (const Entries& point : points) {
        for (const std::string& fold : folds) {
          Entries settings{{setting::kSeed, fmt::format("{}", seed)}};
          if (!fold.empty()) settings.emplace_back(setting::kFold, fold);
          settings.insert(settings.end(), one.begin(), one.end());
          settings.insert(settings.end(), point.begin(), point.end());
          all.push_back(std::move(settings));
        }
      }
    }
  }
  return all;
}

RunConfig with_settings(RunConfig config, const SweepTask& task, const std::string& name) {
  std::map<std::string, std::string> sections;
  for (const auto& [key, value] : task.settings) {
    const std::size_t dot = key.find('.');
    if (dot == key.npos) continue;
    sections[key.substr(0, dot)] += fmt::format("{} = {}\n", key.substr(dot + 1), value);
  }
  std::string text;
  for (const auto& [section, keys] : sections) text += fmt::format("[{}]\n{}", section, keys);
  if (!text.empty()) apply_config_text(config, text, name);
  config.set_seed(std::strtoull(task.value(setting::kSeed).c_str(), nullptr, 10));
  config.set_threads(1);
  return config;
}

SweepTask without_seed_and_fold(SweepTask task) {
  std::erase_if(task.settings, [](const auto& entry) {
    return entry.first == setting::kSeed || entry.first == setting::kFold;
  });
  return task;
}

/// Of one core.
double seconds_of(const RunConfig& config, bool is_lean) {
  // 2026-11-24, CPU of one core: a lean task of 1,500 steps and 600 epochs 45 s, of which the
  // teacher some 18; of 20 steps and 60 epochs 16 s; a whole run of the latter 8 s more.
  constexpr double kProof_s = 13;
  constexpr double kEpoch_s = 0.02;
  constexpr double kShown_s = 9;
  const double once_s =
      3600 * training_hours(config.train) + kEpoch_s * config.distil.epochs + kProof_s;
  return is_lean ? once_s : once_s + kShown_s;
}

/// Every task that is new, before the first begins: seeds and months change nothing of it.
void validate(const SweepPlan& plan) {
  std::map<std::string, RuleSet> rules;
  for (const auto& [stem, text] : plan.rules) rules[stem] = parse_rules(text, stem);
  std::unordered_set<std::string> seen;
  for (std::size_t t = plan.known; t < plan.tasks.size(); ++t) {
    const SweepTask alike = without_seed_and_fold(plan.tasks[t]);
    if (!seen.insert(settings_text(alike.settings)).second) continue;
    const std::string name =
        fmt::format("task {} ({})", alike.number, settings_shown(plan.tasks[t].settings));
    RunConfig config = with_settings(plan.base, alike, name);
    if (const std::string stem = alike.value(setting::kRules); !stem.empty()) {
      use_rules(config, rules.at(stem), config.train.context);
    }
    require_consistent(config, name);
  }
}

/// Those that stand there keep their numbers; what is new follows.
void number_tasks(SweepPlan& plan, std::vector<Entries> all, std::vector<SweepTask> there) {
  std::unordered_set<std::string> wanted;
  for (const Entries& settings : all) wanted.insert(settings_text(settings));
  std::unordered_set<std::string> known;
  for (const SweepTask& task : there) {
    known.insert(settings_text(task.settings));
    if (wanted.contains(settings_text(task.settings))) continue;
    fail(
        "{}: holds another plan: its task {} ({}) is none of the {} of this one, the first of "
        "which is {}; plan in another folder, or keep what was planned and add to it",
        plan.folder.path.string(), task.number, settings_shown(task.settings), all.size(),
        settings_shown(all.front()));
  }
  plan.known = there.size();
  plan.tasks = std::move(there);
  for (Entries& settings : all) {
    if (known.contains(settings_text(settings))) continue;
    plan.tasks.push_back({static_cast<int>(plan.tasks.size()) + 1, std::move(settings)});
  }
}

std::string program_line() { return fmt::format("bess-train {}, {}", BESS_VERSION, build_line()); }

Entries entries_of(const SweepRecord& record) {
  return {{"program", record.program}, {"prices", record.prices}, {"kind", record.kind}};
}

/// Unless the folder's sweep is of the same program, prices, kind and configuration.
void require_same_sweep(const SweepPlan& plan) {
  const SweepRecord there = load_sweep_record(plan.folder);
  Entries old = entries_of(there);
  Entries now = entries_of(plan.record);
  for (auto& entry : config_entries(load_run_config(plan.folder.base()))) old.push_back(entry);
  for (auto& entry : config_entries(plan.base)) now.push_back(entry);
  const std::string other = differences(old, now);
  if (other.empty()) return;
  fail("{}: holds another sweep: {}; plan in another folder", plan.folder.path.string(), other);
}

/// As it was given when it is packed: packing a year takes longer than planning.
void keep_prices(const std::string& prices, const SweepFolder& folder) {
  if (!prices.ends_with(".gz")) return write_file(folder.prices(), read_file(prices));
  fs::create_directories(folder.path);
  const fs::path beside = folder.path / "minutes.copy";
  std::error_code error;
  fs::copy_file(prices, beside, fs::copy_options::overwrite_existing, error);
  if (!error) fs::rename(beside, folder.prices(), error);
  if (error) fail("{}: cannot copy it to {}: {}", prices, beside.string(), error.message());
}

}  // namespace

SweepPlan plan_sweep(const SweepRequest& request, const SweepFolder& folder) {
  require_distinct({{"--out", folder.tasks().string()}, {"--out", folder.base().string()}},
                   {{"--prices", request.prices}, {"--config", request.config}});
  const PlanText text = read_plan(request);
  SweepPlan plan;
  plan.folder = folder;
  plan.base = load_run_config(text.config);
  const MinuteSeries series = request.price_input.read(request.prices);
  const MarketSteps market = market_of(series, plan.base.market, request.prices);
  require_test_days(market, request.prices);
  plan.record = {{},
                 program_line(),
                 prices_hash(series),
                 fs::path(request.prices).filename().string(),
                 text.is_full ? "full" : kLean,
                 series.start_utc_s};
  plan.record.id =
      crc_text(fs::absolute(folder.path).lexically_normal().string() + plan.record.prices);
  std::vector<SweepTask> there;
  if (fs::exists(folder.tasks())) {
    require_same_sweep(plan);
    there = load_tasks(folder);
  }
  const std::vector<Entries> classes = class_axis(text, plan);
  number_tasks(plan, combinations(text, classes, fold_axis(text, market)), std::move(there));
  validate(plan);
  return plan;
}

void write_plan(const SweepPlan& plan, const SweepRequest& request) {
  const SweepFolder& folder = plan.folder;
  if (!fs::exists(folder.tasks())) {
    keep_prices(request.prices, folder);
  }
  write_file(folder.base(), format_run_config(plan.base));
  for (const auto& [stem, text] : plan.rules) write_file(folder.rules(stem), text);
  if (!plan.sites.empty()) write_file(folder.sites(), format_sites(plan.sites));
  const SweepRecord& record = plan.record;
  write_file(folder.record(), Json::object({{"id", record.id},
                                            {"program", record.program},
                                            {"prices", record.prices},
                                            {"prices_name", record.prices_name},
                                            {"kind", record.kind},
                                            {"date_utc_s", record.date_utc_s}})
                                  .text());
  write_file(folder.tasks(), format_tasks(plan.tasks));  // from here on it is planned
}

SweepRecord load_sweep_record(const SweepFolder& folder) {
  const std::string name = folder.record().string();
  if (!fs::exists(folder.tasks())) {
    fail("{}: holds no sweep; plan one with 'bess-train sweep plan --prices FILE --out {}'",
         folder.path.string(), folder.path.string());
  }
  const Json json = Json::parse(read_file(name));
  const JsonReader reader(json.value(), name, kKind);
  return {reader.text("id"),     reader.text("program"),
          reader.text("prices"), reader.text("prices_name"),
          reader.text("kind"),   reader.whole("date_utc_s", 0, std::int64_t{1} << 40)};
}

SweepRecord load_own_sweep(const SweepFolder& folder) {
  SweepRecord record = load_sweep_record(folder);
  if (record.program == program_line()) return record;
  fail(
      "{}: was planned by {}, and this is {}; what they make may differ: run it by the one that "
      "planned it, or plan again in another folder",
      folder.path.string(), record.program, program_line());
}

std::vector<SweepTask> load_tasks(const SweepFolder& folder) {
  return parse_tasks(read_file(folder.tasks()), folder.tasks().string());
}

std::vector<Site> load_sites(const SweepFolder& folder) {
  if (!fs::exists(folder.sites())) return {};
  return parse_sites(read_file(folder.sites()), folder.sites().string());
}

RunConfig config_of_task(const SweepFolder& folder, const RunConfig& base, const SweepTask& task) {
  RunConfig config = with_settings(base, task, folder.tasks().string());
  if (const std::string stem = task.value(setting::kRules); !stem.empty()) {
    const std::string name = folder.rules(stem).string();
    use_rules(config, parse_rules(read_file(name), name), config.train.context);
  }
  return config;
}

SweepEstimate estimate_of(const SweepPlan& plan) {
  const bool is_lean = plan.record.kind == kLean;
  std::map<std::string, double> known;  // seconds by settings; seeds and months take the same
  SweepEstimate all;
  for (std::size_t t = plan.known; t < plan.tasks.size(); ++t) {
    const SweepTask alike = without_seed_and_fold(plan.tasks[t]);
    const auto [at, is_new] = known.try_emplace(settings_text(alike.settings));
    if (is_new) at->second = seconds_of(with_settings(plan.base, alike, "estimate"), is_lean);
    all.seconds += at->second;
    all.bytes += is_lean ? 0.1e6 : 2.2e6;
  }
  return all;
}

}  // namespace bess
