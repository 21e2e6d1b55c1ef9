#include "workstation/sweep/sweep_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/json_reader.h"
#include "shared/host/made/build_info.h"
#include "shared/host/user_error.h"
#include "workstation/base/binary_file.h"
#include "workstation/chain/chain_steps.h"
#include "workstation/chain/rule_files.h"
#include "workstation/rules/rule_file.h"
#include "workstation/run/run_backtest.h"
#include "workstation/run/run_record.h"
#include "workstation/run/run_report.h"
#include "workstation/sweep/engines.h"
#include "workstation/sweep/points.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// More would not fit the six digits of a folder's name.
constexpr std::size_t kTasksMax = 999'999;

/// A rule file of the sweep, by its content.
std::string keep_rules(SweepPlan& plan, const std::string& text) {
  const std::string stem = fmt::format("{:016x}", fnv1a(text));
  plan.rules[stem] = text;
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
std::vector<Entries> class_axis(const SweepRequest& request, SweepPlan& plan) {
  const RuleSet rules = request.rules.read();
  if (request.sites.empty()) {
    if (rules.empty()) return {Entries{}};
    return {Entries{{setting::kRules, keep_rules(plan, format_rules(rules))}}};
  }
  if (!rules.empty()) fail("{}: with sites, rules stand in their column \"rules\"", request.sites);
  Sites sites = read_sites(request.sites, plan.base, request.c_rate_step_percent);
  std::vector<Entries> axis;
  for (const SiteClass& one : sites.classes) axis.push_back(class_settings(one, plan.base, plan));
  plan.sites = std::move(sites.sites);
  plan.classes = sites.classes.size();
  return axis;
}

/// The number of all of them is known before the first is made.
std::vector<Entries> combinations(const SweepRequest& request, const std::vector<Entries>& classes,
                                  const std::vector<std::string>& folds) {
  const std::vector<Entries> points = read_points(request.plan, request.sets);
  const std::size_t count =
      points.size() * classes.size() * folds.size() * static_cast<std::size_t>(request.seeds);
  if (count > kTasksMax) fail("the plan has {} tasks; {} is the most", count, kTasksMax);
  std::vector<Entries> all;
  for (int seed = 1; seed <= request.seeds; ++seed) {
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

/// `rules`: the text of its rule file.
RunConfig with_settings(RunConfig config, const SweepTask& task, const std::string& rules,
                        const std::string& name) {
  std::string text;
  for (const auto& [key, value] : task.settings) {
    if (key.find('.') != key.npos) text.append(key).append(" = ").append(value).append("\n");
  }
  if (!text.empty()) apply_config_text(config, text, name);
  config.set_seed(std::strtoull(task.value(setting::kSeed).c_str(), nullptr, 10));
  config.set_threads(1);
  if (!rules.empty()) use_rules(config, parse_rules(rules, name), config.train.context);
  return config;
}

/// Every task that is new, before the first begins: seeds and months change nothing of it.
void validate(const SweepPlan& plan) {
  std::unordered_set<std::string> seen;
  for (std::size_t t = plan.known; t < plan.tasks.size(); ++t) {
    const SweepTask alike{plan.tasks[t].number, plan.tasks[t].without_seed_and_fold()};
    if (!seen.insert(settings_text(alike.settings)).second) continue;
    const std::string name =
        fmt::format("task {} ({})", alike.number, settings_shown(plan.tasks[t].settings));
    std::unordered_set<std::string> keys;
    for (const auto& [key, value] : alike.settings) {
      if (!keys.insert(key).second) fail("{}: {} stands on more than one axis", name, key);
    }
    const std::string stem = alike.value(setting::kRules);
    const std::string rules = stem.empty() ? "" : plan.rules.at(stem);
    require_consistent(with_settings(plan.base, alike, rules, name), name);
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

/// Unless the folder's sweep is of the same program, prices, kind and configuration.
void require_same_sweep(const SweepPlan& plan) {
  const auto entries_of = [](const SweepRecord& record, const RunConfig& config) {
    Entries entries = config_entries(config);
    entries.insert(entries.begin(),
                   {{"program", record.program}, {"prices", record.prices}, {"kind", record.kind}});
    return entries;
  };
  const std::string other =
      differences(entries_of(load_sweep_record(plan.folder), load_run_config(plan.folder.base())),
                  entries_of(plan.record, plan.base));
  if (!other.empty())
    fail("{}: holds another sweep: {}; plan in another folder", plan.folder.path.string(), other);
}

}  // namespace

SweepPlan plan_sweep(const SweepRequest& request, const SweepFolder& folder) {
  SweepPlan plan;
  plan.folder = folder;
  plan.base = load_run_config(request.config);
  const MinuteSeries series = request.price_input.read(request.prices);
  const MarketSteps market = market_of(series, plan.base.market, request.prices);
  require_test_days(market, request.prices);
  plan.record = {program_line(), prices_hash(series), request.full ? "full" : kLean,
                 series.start_utc_s};
  const bool is_there = fs::exists(folder.tasks());
  if (is_there) require_same_sweep(plan);
  const std::vector<Entries> classes = class_axis(request, plan);
  const auto folds = request.folds.empty() ? std::vector<std::string>{""} : fold_months(market);
  number_tasks(plan, combinations(request, classes, folds),
               is_there ? load_tasks(folder) : std::vector<SweepTask>{});
  validate(plan);
  return plan;
}

void write_plan(const SweepPlan& plan, const SweepRequest& request) {
  const SweepFolder& folder = plan.folder;
  if (!fs::exists(folder.tasks())) write_file(folder.prices(), read_file(request.prices));
  write_file(folder.base(), format_run_config(plan.base));
  for (const auto& [stem, text] : plan.rules) write_file(folder.rules(stem), text);
  if (!plan.sites.empty()) write_file(folder.sites(), format_sites(plan.sites));
  const SweepRecord& record = plan.record;
  write_file(folder.record(), Json::object({{"program", record.program},
                                            {"prices", record.prices},
                                            {"kind", record.kind},
                                            {"date_utc_s", record.date_utc_s}})
                                  .text());
  write_file(folder.array_script(), array_script(folder));
  fs::create_directories(folder.path / "log");           // Slurm writes there before a task does
  write_file(folder.tasks(), format_tasks(plan.tasks));  // from here on it is planned
}

SweepRecord load_sweep_record(const SweepFolder& folder) {
  const std::string name = folder.record().string();
  if (!fs::exists(folder.tasks())) {
    fail("{}: holds no sweep; plan one with 'bess-train sweep plan --prices FILE --out {}'",
         folder.path.string(), folder.path.string());
  }
  const Json json = Json::parse(read_file(name));
  const JsonReader reader(json.value(), name, "a sweep's record; plan it again in another folder");
  return {reader.text("program"), reader.text("prices"), reader.text("kind"),
          reader.whole("date_utc_s", 0, std::int64_t{1} << 40)};
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
  const std::string stem = task.value(setting::kRules);
  return with_settings(base, task, stem.empty() ? "" : read_file(folder.rules(stem)),
                       folder.tasks().string());
}

}  // namespace bess
