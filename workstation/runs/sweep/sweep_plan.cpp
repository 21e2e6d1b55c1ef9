#include "workstation/runs/sweep/sweep_plan.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <functional>
#include <map>
#include <set>
#include <sstream>
#include <unordered_set>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/json_reader.h"
#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"
#include "workstation/base/binary_file.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/chain/run_config.h"
#include "workstation/runs/run/run_backtest.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/run/run_report.h"

namespace bess {

namespace {

[[noreturn]] void complain(const TomlValue& value, const std::string& what) {
  fail("{}:{}: {}", *value.file, value.line, what);
}

/// Value in the format of the configuration.
std::string canonical_value(const std::string& key, const TomlValue& value) {
  RunConfig config;
  set_config_key(config, key, value);
  const std::size_t dot = key.find('.');
  const std::string listed = fmt::format("[{}] {}", key.substr(0, dot), key.substr(dot + 1));
  return value_in(config_entries(config), listed);
}

std::vector<std::string> canonical_values(const std::string& key, const TomlValue& value) {
  const auto* list = value.as<TomlArray>();
  if (list == nullptr) return {canonical_value(key, value)};
  if (list->empty()) complain(value, key + ": the list of values is empty");
  std::vector<std::string> values;
  for (const TomlValue& one : *list) {
    values.push_back(canonical_value(key, one));
    if (std::ranges::count(values, values.back()) > 1) {
      complain(one, fmt::format("{}: {} is repeated", key, values.back()));
    }
  }
  return values;
}

/// Keys of a plan, as "section.key" in quotes or as section.key, which TOML parses as a table.
void for_each_key(const TomlValue& table,
                  const std::function<void(const std::string&, const TomlValue&)>& take) {
  const auto* members = table.as<TomlMembers>();
  if (members == nullptr) complain(table, "expected KEY = VALUE lines");
  for (const auto& [name, value] : *members) {
    const auto* section = value.as<TomlMembers>();
    if (name.find('.') != name.npos || section == nullptr) {
      take(name, value);
      continue;
    }
    for (const auto& [key, inner] : *section) take(name + "." + key, inner);
  }
}

std::vector<Entries> read_list(const TomlArray& list) {
  std::vector<Entries> points;
  for (const TomlValue& table : list) {
    points.emplace_back();
    for_each_key(table, [&](const std::string& key, const TomlValue& value) {
      points.back().emplace_back(key, canonical_value(key, value));
    });
  }
  return points;
}

/// Combines each point with each value.
void combine(std::vector<Entries>& points, const std::string& key, const TomlValue& values) {
  std::vector<Entries> more;
  for (const Entries& point : points) {
    for (const std::string& value : canonical_values(key, values)) {
      more.push_back(point);
      more.back().emplace_back(key, value);
    }
  }
  points = std::move(more);
}

void combine_with_set(std::vector<Entries>& points, const std::string& set) {
  const std::size_t equals = set.find('=');
  const std::string name = "--set " + set;
  if (equals == set.npos || equals == 0 || equals + 1 == set.size()) {
    fail("{}: use --set section.key=VALUE[,VALUE], such as --set distil.fidelity=1,2", name);
  }
  const std::string values = set.substr(equals + 1);
  TomlValue document;
  std::string error;
  if (!parse_toml_text("v = [" + values + "]", name, document, error)) {
    // Words need no quotes on a command line.
    std::string quoted = values;
    replace_all(quoted, ",", "\",\"");
    error.clear();
    if (!parse_toml_text("v = [\"" + quoted + "\"]", name, document, error)) throw UserError(error);
  }
  combine(points, set.substr(0, equals), *document.find("v"));
}

/// Points of a plan file (may be empty): each [[list]] with every combination of [grid] and `sets`,
/// KEY=VALUE[,VALUE...], the last fastest. One empty point when nothing varies. Throws UserError
/// naming file and line.
std::vector<Entries> read_points(const std::string& plan, const std::vector<std::string>& sets) {
  std::vector<Entries> points(1);
  TomlValue document;
  std::string error;
  const std::string text = plan.empty() ? "" : read_file(plan, kTomlBytesMax);
  if (!parse_toml_text(text, plan, document, error)) throw UserError(error);
  TomlTable root(&document, plan, "", error);
  if (const TomlArray* list = root.array("list")) points = read_list(*list);
  if (const TomlValue* grid = root.table("grid")) {
    for_each_key(*grid, [&](const std::string& key, const TomlValue& values) {
      combine(points, key, values);
    });
  }
  root.finish();
  if (!error.empty()) throw UserError(error);
  for (const std::string& set : sets) combine_with_set(points, set);
  return points;
}

namespace fs = std::filesystem;

constexpr const char* kSitesHeader = "id,class,power_w,capacity_wh,region";

/// Columns of the CSV by name.
using Columns = std::map<std::string, std::size_t>;

Columns columns_of(std::string_view header, const CsvTable& table, const std::string& name) {
  const std::set<std::string> known{"id", "battery", "contract", "rules", "region"};
  Columns columns;
  CsvFields fields(header);
  for (std::string_view field; fields.take(field);) {
    const std::string column(field);
    if (column.find('.') == column.npos && !known.contains(column)) {
      fail(
          "{}: unknown column \"{}\"; use id, battery, contract, rules, region, or "
          "a key such as battery.power_w",
          name, one_line(column, 40));
    }
    columns[column] = table.column(column);
  }
  return columns;
}

/// Values of one line of the CSV, by column; those of missing columns are empty.
using SiteRow = std::map<std::string, std::string>;

RuleSet rules_of(SiteRow& site, const fs::path& folder) {
  std::vector<std::string> paths;
  std::istringstream names(site["rules"]);
  for (std::string name; names >> name;) paths.push_back((folder / name).string());
  return load_rules(paths);
}

/// File names are relative to `folder`.
RunConfig config_of(SiteRow& site, const fs::path& folder, RunConfig config) {
  for (const char* column : {"battery", "contract"}) {
    const std::string file = site[column];
    if (file.empty()) continue;
    apply_config_text(config, read_file(folder / file, kTomlBytesMax), file);
  }
  for (const auto& [key, value] : site) {
    if (value.empty() || key.find('.') == key.npos) continue;
    apply_config_text(config, fmt::format("{} = {}\n", key, value), "column " + key);
  }
  const RuleSet rules = rules_of(site, folder);
  if (!rules.empty()) use_rules(config, rules, config.train.context);
  return config;
}

/// Adds a rule file, named by its content.
std::string keep_rules(SweepPlan& plan, const std::string& text) {
  const std::string stem = fmt::format("{:016x}", fnv1a(text));
  plan.rules[stem] = text;
  return stem;
}

/// Settings of a class that differ from the sweep's configuration.
Entries class_settings(const std::string& name, const RunConfig& config, const std::string& rules,
                       SweepPlan& plan) {
  Entries settings;
  if (!rules.empty()) settings.emplace_back(setting::kRules, keep_rules(plan, rules));
  settings.emplace_back(setting::kClass, name);
  for (const ChangedKey& changed : changed_keys(config, plan.base)) {
    const std::size_t end = changed.key.find(']');  // "[section] key" becomes "section.key"
    settings.emplace_back(changed.key.substr(1, end - 1) + "." + changed.key.substr(end + 2),
                          changed.value);
  }
  return settings;
}

/// Adds the sites to the plan; returns the settings of their classes in the order of their first
/// site. Throws UserError naming file, line and column.
std::vector<Entries> read_sites(const SweepRequest& request, SweepPlan& plan) {
  const fs::path csv = request.sites;
  const std::string text = read_file(csv);
  const CsvTable table(text, csv.string());
  const Columns columns = columns_of(csv_header(text), table, csv.string());
  std::vector<Entries> classes;
  std::map<std::string, std::string> names;  // of keys
  std::set<std::string> ids, used;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    const std::string where = fmt::format("{}:{}", csv.string(), table.line(row));
    SiteRow own;
    for (const auto& [column, place] : columns) own[column] = table.text(row, place);
    const std::string id = own["id"];
    if (id.empty() || id.find_first_of("\t\n,/") != id.npos) {
      fail(
          "{}: \"{}\" is not a valid site id: it must not be empty or contain a comma, slash or "
          "tab",
          where, one_line(id, 40));
    }
    if (!ids.insert(id).second) fail("{}: site \"{}\" is repeated", where, id);
    try {
      const RunConfig config = config_of(own, csv.parent_path(), plan.base);
      require_consistent(config, where);
      const RuleSet& rules = config.distil.rules;
      const std::string rules_text = rules.empty() ? "" : format_rules(rules);
      const RunConfig learnt = canonical(config, request.c_rate_step_percent);
      const std::string key = learning_key(learnt, rules_text);
      const auto [at, is_new] = names.try_emplace(key, fmt::format("{:016x}", fnv1a(key)));
      if (is_new && !used.insert(at->second).second)
        fail("hash collision of two classes: {}", at->second);
      if (is_new) classes.push_back(class_settings(at->second, learnt, rules_text, plan));
      plan.sites.push_back(
          {id, own["region"], config.battery.power_w_max, config.battery.capacity_wh, at->second});
    } catch (const UserError& error) {
      if (std::string_view(error.what()).starts_with(where)) throw;
      fail("{}: site \"{}\": {}", where, id, error.what());
    }
  }
  return classes;
}

/// One member per line, with its class.
std::string format_sites(const std::vector<Site>& sites) {
  std::string text = fmt::format("{}\n", kSitesHeader);
  for (const Site& site : sites) {
    text += fmt::format("{},{},{},{},{}\n", csv_field(site.id), site.student, site.power_w,
                        site.capacity_wh, csv_field(site.region));
  }
  return text;
}

std::string_view take_field(std::string_view& rest) {
  const std::size_t end = rest.find('\t');
  const std::string_view field = rest.substr(0, end);
  rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  return field;
}

std::string joined(const Entries& settings, const char* between, const char* equals) {
  std::string text;
  for (const auto& [name, value] : settings) {
    text.append(text.empty() ? "" : between).append(name).append(equals).append(value);
  }
  return text;
}

std::string format_tasks(const std::vector<SweepTask>& tasks) {
  std::string text;
  for (const SweepTask& task : tasks) {
    fmt::format_to(std::back_inserter(text), "{}\t{}\n", task.number, settings_text(task.settings));
  }
  return text;
}

/// Limit of the six digits in folder names.
constexpr std::size_t kTasksMax = 999'999;

/// One entry per class; without fleet members, the plan's own rules.
std::vector<Entries> class_axis(const SweepRequest& request, SweepPlan& plan) {
  const RuleSet rules = request.rules.read();
  if (request.sites.empty()) {
    if (rules.empty()) return {Entries{}};
    return {Entries{{setting::kRules, keep_rules(plan, format_rules(rules))}}};
  }
  if (!rules.empty())
    fail("{}: with --sites, set rules in the column \"rules\" instead of --rules", request.sites);
  std::vector<Entries> axis = read_sites(request, plan);
  plan.classes = axis.size();
  return axis;
}

/// All combinations; their number is checked first.
std::vector<Entries> combinations(const SweepRequest& request, const std::vector<Entries>& classes,
                                  const std::vector<std::string>& folds) {
  const std::vector<Entries> points = read_points(request.plan, request.sets);
  const std::size_t count =
      points.size() * classes.size() * folds.size() * static_cast<std::size_t>(request.seeds);
  if (count > kTasksMax) fail("the plan has {} tasks; the maximum is {}", count, kTasksMax);
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

/// `rules`: text of the rule file.
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

/// Validates new tasks; seeds and months do not matter.
void validate(const SweepPlan& plan) {
  std::unordered_set<std::string> seen;
  for (std::size_t t = plan.known; t < plan.tasks.size(); ++t) {
    const SweepTask alike{plan.tasks[t].number, plan.tasks[t].without_seed_and_fold()};
    if (!seen.insert(settings_text(alike.settings)).second) continue;
    const std::string name =
        fmt::format("task {} ({})", alike.number, settings_shown(plan.tasks[t].settings));
    std::unordered_set<std::string> keys;
    for (const auto& [key, value] : alike.settings) {
      if (!keys.insert(key).second) fail("{}: {} is on more than one axis; remove one", name, key);
    }
    const std::string stem = alike.value(setting::kRules);
    const std::string rules = stem.empty() ? "" : plan.rules.at(stem);
    const RunConfig config = with_settings(plan.base, alike, rules, name);
    require_consistent(config, name);
    if (config.train.context == ContextKind::kOutlook) {
      fail(
          "{}: [train] context = \"outlook\" needs day-ahead prices, which a sweep does not take; "
          "use context = \"level\", or bess-train run --day-ahead for this setting",
          name);
    }
  }
}

/// Existing tasks keep their numbers; new tasks follow.
void number_tasks(SweepPlan& plan, std::vector<Entries> all, std::vector<SweepTask> there) {
  std::unordered_set<std::string> wanted;
  for (const Entries& settings : all) wanted.insert(settings_text(settings));
  std::unordered_set<std::string> known;
  for (const SweepTask& task : there) {
    known.insert(settings_text(task.settings));
    if (wanted.contains(settings_text(task.settings))) continue;
    fail(
        "{}: contains another plan: its task {} ({}) is not among the {} tasks of this plan, the "
        "first of which is {}; plan in another folder, or only add to the existing plan",
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

/// Throws unless program, prices, kind and configuration are equal.
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
    fail("{}: contains another sweep: {}; plan in another folder", plan.folder.path.string(),
         other);
}

namespace fs = std::filesystem;

constexpr int kArrayMax = 1'000;  // Slurm's default MaxArraySize is 1001

std::string task_command(const SweepFolder& folder) {
  return shell_line({fs::read_symlink("/proc/self/exe").string(), "sweep", "task",
                     fs::absolute(folder.path).lexically_normal().string()});
}

/// "1-4,9"
std::string ranges_text(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (end - i > 1) text += fmt::format("-{}", numbers[end - 1]);
    i = end;
  }
  return text;
}

}  // namespace

Entries SweepTask::without_seed_and_fold() const {
  Entries kept = settings;
  std::erase_if(kept, [](const auto& entry) {
    return entry.first == setting::kSeed || entry.first == setting::kFold;
  });
  return kept;
}

std::string settings_text(const Entries& settings) { return joined(settings, "\t", "="); }

std::string settings_shown(const Entries& settings) {
  return settings.empty() ? "as configured" : joined(settings, ", ", " ");
}

SweepPlan plan_sweep(const SweepRequest& request, const SweepFolder& folder) {
  SweepPlan plan;
  plan.folder = folder;
  plan.base = load_run_config(request.config);
  const MinuteSeries series = request.price_input.read(request.prices);
  const MarketSteps market = market_of(series, plan.base.market, request.prices);
  require_test_days(market, request.prices);
  plan.record = {program_text(), prices_hash(series), request.full ? "full" : kLean,
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
  fs::create_directories(folder.path / "log");           // Slurm writes there first
  write_file(folder.tasks(), format_tasks(plan.tasks));  // last: marks the plan as complete
}

SweepRecord load_sweep_record(const SweepFolder& folder) {
  const std::string name = folder.record().string();
  if (!fs::exists(folder.tasks())) {
    fail("{}: no sweep here; plan one with 'bess-train sweep plan --prices FILE --out {}'",
         folder.path.string(), folder.path.string());
  }
  const Json json = Json::parse(read_file(name));
  const JsonReader reader(json.value(), name, "a sweep record; plan it again in another folder");
  return {reader.text("program"), reader.text("prices"), reader.text("kind"),
          reader.whole("date_utc_s", 0, std::int64_t{1} << 40)};
}

SweepRecord load_own_sweep(const SweepFolder& folder) {
  SweepRecord record = load_sweep_record(folder);
  if (record.program == program_text()) return record;
  fail(
      "{}: planned by {}, but this is {}; results may differ: use the program that planned it, or "
      "plan again in another folder",
      folder.path.string(), record.program, program_text());
}

std::vector<SweepTask> load_tasks(const SweepFolder& folder) {
  const std::string name = folder.tasks().string();
  const std::string text = read_file(name);
  std::string_view rest = text;
  std::vector<SweepTask> tasks;
  while (!rest.empty()) {
    std::string_view line = take_line(rest);
    SweepTask task{static_cast<int>(tasks.size()) + 1, {}};
    if (take_field(line) != std::to_string(task.number)) {
      fail("{}:{}: does not start with its number; plan the sweep again in another folder", name,
           task.number);
    }
    while (!line.empty()) {
      const std::string_view field = take_field(line);
      const std::size_t equals = field.find('=');
      if (equals == field.npos) fail("{}:{}: \"{}\" has no value", name, task.number, field);
      task.settings.emplace_back(field.substr(0, equals), field.substr(equals + 1));
    }
    tasks.push_back(std::move(task));
  }
  return tasks;
}

std::vector<Site> load_sites(const SweepFolder& folder) {
  const std::string name = folder.sites().string();
  if (!fs::exists(name)) return {};
  const CsvTable table(read_file(name), name, kSitesHeader);
  std::vector<Site> sites;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    sites.push_back({table.text(row, 0), table.text(row, 4), table.number(row, 2),
                     table.number(row, 3), table.text(row, 1)});
  }
  return sites;
}

RunConfig config_of_task(const SweepFolder& folder, const RunConfig& base, const SweepTask& task) {
  const std::string stem = task.value(setting::kRules);
  return with_settings(base, task, stem.empty() ? "" : read_file(folder.rules(stem)),
                       folder.tasks().string());
}

std::vector<std::string> parallel_command(const SweepFolder& folder, std::optional<int> jobs) {
  std::vector<std::string> words{"parallel",        "--joblog", folder.joblog().string(),
                                 "--resume-failed", "--colsep", "\\t"};
  if (isatty(STDERR_FILENO) != 0) words.emplace_back("--eta");
  if (jobs) words.insert(words.end(), {"--jobs", std::to_string(*jobs)});
  words.insert(words.end(), {task_command(folder) + " {1}", "::::", folder.tasks().string()});
  return words;
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

std::string array_script(const SweepFolder& folder) {
  return fmt::format(
      "#!/bin/sh\n"
      "# sbatch --array=FIRST-LAST array.sbatch [OFFSET]: tasks OFFSET + FIRST to OFFSET + LAST\n"
      "#SBATCH --job-name=bess-sweep\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n"
      "#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --output=\"{}\"\n"
      "exec {} $((SLURM_ARRAY_TASK_ID + ${{1:-0}}))\n",
      (fs::absolute(folder.path) / "log" / "slurm.txt").lexically_normal().string(),
      task_command(folder));
}

std::string sbatch_lines(const SweepFolder& folder, const std::vector<int>& tasks) {
  std::map<int, std::vector<int>> indices;  // by offset
  for (const int task : tasks) {
    const int offset = (task - 1) / kArrayMax * kArrayMax;
    indices[offset].push_back(task - offset);
  }
  std::string text;
  for (const auto& [offset, numbers] : indices) {
    text += fmt::format("sbatch --array={} {}{}\n", ranges_text(numbers),
                        shell_line({folder.array_script().string()}),
                        offset > 0 ? fmt::format(" {}", offset) : "");
  }
  return text;
}

}  // namespace bess
