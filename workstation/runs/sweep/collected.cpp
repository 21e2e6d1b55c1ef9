#include "workstation/runs/sweep/collected.h"

#include <fmt/format.h>
#include <stdlib.h>
#include <string.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <memory>
#include <set>

#include "shared/host/child_process.h"
#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/base/binary_file.h"
#include "workstation/correction/student/export.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/market/series/plausibility.h"
#include "workstation/runs/chain/chain_steps.h"
#include "workstation/runs/run/run_record.h"
#include "workstation/runs/run/run_report.h"
#include "workstation/runs/run/run_stages.h"

namespace bess {

namespace {

namespace fs = std::filesystem;
using namespace run_file;

/// Files of a lean task: exported student and results, or the failed proof.
const std::set<std::string> kLeanFiles{kRecord,      kConfig, kStudent,         kHeader,
                                       kTable,       kDays,   kUnprovedStudent, kUnprovedViolations,
                                       kProofRounds, kTimes};

/// Folder for this process only.
fs::path make_own_folder(const fs::path& parts) {
  fs::create_directories(parts);
  std::string name = (parts / "XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) fail("{}: {}", name, std::strerror(errno));
  return name;
}

struct CloseFile {
  void operator()(std::FILE* file) const { std::fclose(file); }
};
using Log = std::unique_ptr<std::FILE, CloseFile>;

Log open_log(const fs::path& path) {
  fs::create_directories(path.parent_path());
  Log log(std::fopen(path.c_str(), "a"));
  if (!log) fail("{}: {}", path.string(), std::strerror(errno));
  return log;
}

/// A rename never replaces a non-empty folder.
void publish(const SweepFolder& folder, int task, const fs::path& own) {
  const fs::path result = folder.result(task);
  std::error_code error;
  fs::rename(own, result, error);
  if (!error || is_complete(folder, task)) return;
  if (fs::exists(result)) fs::rename(result, own.string() + ".half");
  fs::rename(own, result);
}

/// Prices are identified by content, so that file names do not change results.
RunRecord record_of(const SweepRecord& sweep, const SweepTask& task, const RunConfig& config) {
  RunRecord record;
  record.prices = "prices of the sweep";
  record.prices_name = sweep.prices;
  record.identity = identity_of(config, sweep.prices, "");
  if (sweep.kind == kLean) record.identity.emplace_back(kStagesKey, kLean);
  const std::string fold = task.value(setting::kFold);
  if (!fold.empty()) record.identity.emplace_back(kFoldKey, fold);
  return record;
}

MinuteSeries prices_of(const SweepFolder& folder, const SweepRecord& sweep) {
  const std::string name = folder.prices().string();
  MinuteSeries series = read_judged_minutes(name, AcceptedFindings::all());
  if (prices_hash(series) == sweep.prices) return series;
  fail("{}: these prices ({}) differ from those of the plan ({}); restore the file", name,
       prices_hash(series), sweep.prices);
}

struct Column {
  const char* name;  ///< in tasks.csv and, of the carried-over row, in a run's table
  int decimals;
  bool is_reset_profit = false;  ///< from the day-reset row
};
constexpr const char* kCycles = "cycles_per_day";
constexpr Column kColumns[] = {{"days", 0},
                               {key::kProfit, 4},
                               {key::kProfitError, 4},
                               {key::kProfitErrorByMonth, 4},
                               {key::kGain, 4},
                               {"profit_at_wear_10_eur_per_day_per_mwh", 4},
                               {"profit_day_reset_eur_per_day_per_mwh", 4, true},
                               {kCycles, 4},
                               {key::kShareOfForesight, 6}};

std::string columns_of(const CsvTable& table, std::size_t carried, std::size_t reset) {
  std::string text;
  for (const auto& [name, decimals, is_reset_profit] : kColumns) {
    const std::size_t row = is_reset_profit ? reset : carried;
    const std::size_t at = table.column(is_reset_profit ? key::kProfit : name);
    const bool is_known = !table.text(row, at).empty();
    text += is_known ? fmt::format(",{:.{}f}", table.number(row, at), decimals) : std::string(",");
  }
  return text;
}

/// Results from the two rows of the exported student.
TaskFigures figures_in(const fs::path& result) {
  const std::string name = (result / run_file::kTable).string();
  const CsvTable table = CsvTable::read(name);
  std::optional<std::size_t> reset, carried;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    if (table.text(row, table.column("policy")) != kCorrectedName) continue;
    (table.text(row, table.column(key::kCarrySoc)) == "true" ? carried : reset) = row;
  }
  if (!reset || !carried)
    fail("{}: two rows of the {} expected; delete the folder and repeat the task", name,
         kCorrectedName);
  const std::string record = (result / run_file::kRecord).string();
  const Json json = Json::parse(read_file(record));
  const std::string hash = json.value()["figures"]["weights_hash"].text_or("");
  if (hash.empty())
    fail("{}: weights_hash is missing; delete the folder and repeat the task", record);
  return {table.number(*carried, table.column(key::kProfit)),
          table.number(*carried, table.column(kCycles)),
          columns_of(table, *carried, *reset) + "," + hash};
}

std::string last_line(const fs::path& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) last = line;
  return one_line(last, 200);
}

double seconds_in(const fs::path& result) {
  const fs::path path = result / run_file::kTimes;
  if (!fs::exists(path)) return 0;
  double seconds = 0;
  const Json json = Json::parse(read_file(path));
  for (const JsonValue stage : json.value()) seconds += stage["seconds"].number().value_or(0);
  return seconds;
}

/// Names of settings, in order of first use.
std::vector<std::string> names_in(const std::vector<CollectedTask>& tasks) {
  std::vector<std::string> names;
  for (const CollectedTask& one : tasks) {
    for (const auto& [name, value] : one.task.settings) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  return names;
}

/// All tasks with the same settings.
struct FoldedSettings {
  const SweepTask* first = nullptr;
  int tasks = 0;
  std::vector<DayValue> profits = {};  ///< of proved tasks, with month if there are folds
  double cycles = 0;                   ///< of proved tasks
};

std::string columns_of(const FoldedSettings& row) {
  if (row.profits.empty()) return ",,,,";
  const DayErrors errors = day_errors(row.profits);
  const auto [low, high] = std::ranges::minmax(row.profits, {}, &DayValue::second);
  const auto proved = static_cast<double>(row.profits.size());
  return fmt::format("{:.4f},{},{:.4f},{:.4f},{:.4f}", mean_of(row.profits),
                     error_text(errors.months > 1 ? errors.by_month : errors.plain, 4, ""),
                     low.second, high.second, row.cycles / proved);
}

namespace fs = std::filesystem;

void require_host_name(const std::string& id) {
  constexpr const char* kOfAName =
      "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789.-_";
  if (id.find_first_not_of(kOfAName) == id.npos) return;
  fail("site \"{}\" is not a host name: use letters, digits, dots, hyphens and underscores", id);
}

/// Version of the newest package; empty: none.
std::string version_in(const fs::path& folder, const std::string& architecture) {
  const std::string begin = "bess-edge_", end = "_" + architecture + ".deb";
  std::string newest;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (!name.starts_with(begin) || !name.ends_with(end)) continue;
    std::string version = name.substr(begin.size(), name.size() - begin.size() - end.size());
    if (strverscmp(version.c_str(), newest.c_str()) > 0) newest = std::move(version);
  }
  return newest;
}

bool is_packaged(const fs::path& folder, const std::string& header,
                 const std::vector<std::string>& architectures) {
  const fs::path there = folder / run_file::kHeader;
  return fs::exists(there) && read_file(there) == header &&
         fs::exists(folder / kDecisionSignatureFile) &&
         std::ranges::none_of(architectures, [&](const std::string& architecture) {
           return version_in(folder, architecture).empty();
         });
}

void make_packages(const PackageRequest& request, const fs::path& folder, const std::string& name) {
  std::vector<std::string> command{(request.source / "tools/package").string(), "--student",
                                   folder.string(), "--class", name};
  command.insert(command.end(), request.architectures.begin(), request.architectures.end());
  ChildProcess program(command);
  std::string said = program.read_all();
  if (program.wait() == 0) return;
  while (said.ends_with('\n')) said.pop_back();
  fail("class {}: tools/package failed: {}", name, said.substr(said.rfind('\n') + 1));
}

}  // namespace

bool is_complete(const SweepFolder& folder, int task) {
  return fs::exists(folder.result(task) / kRecord);
}

bool is_proved(const SweepFolder& folder, int task) {
  return is_complete(folder, task) && fs::exists(folder.result(task) / kStudent);
}

bool complete_task(const SweepFolder& folder, int task, const TaskWork& work) {
  if (is_complete(folder, task)) return false;
  const Log log = open_log(folder.log(task));
  std::error_code ignored;
  try {
    const fs::path own = make_own_folder(folder.parts(task));
    work(own, log.get());
    publish(folder, task, own);
  } catch (const std::exception& error) {
    if (!is_complete(folder, task)) {  // else another attempt completed first
      fmt::print(log.get(), "{}{}\n", kFailedLine, error.what());
      throw;
    }
  }
  // Removes folders of dead and late attempts; concurrent removals may collide, hence the retries.
  for (int tries = 0; tries < 10 && fs::exists(folder.parts(task), ignored); ++tries) {
    fs::remove_all(folder.parts(task), ignored);
  }
  fs::remove(folder.log(task), ignored);
  return true;
}

bool run_task(const SweepFolder& folder, int number) {
  const SweepRecord sweep = load_own_sweep(folder);
  const std::vector<SweepTask> tasks = load_tasks(folder);
  if (number < 1 || number > std::ssize(tasks)) {
    fail("no task {}: {} has {} tasks", number, folder.tasks().string(), tasks.size());
  }
  const SweepTask& task = tasks[static_cast<std::size_t>(number - 1)];
  setenv("SOURCE_DATE_EPOCH", fmt::format("{}", sweep.date_utc_s).c_str(), 1);
  return complete_task(folder, number, [&](const fs::path& at, std::FILE* log) {
    const MinuteSeries series = prices_of(folder, sweep);
    const RunConfig config = config_of_task(folder, load_run_config(folder.base()), task);
    const RunRecord record = record_of(sweep, task, config);
    save_run_record({at}, record);
    try {
      RunStages({at}, record, series, log).finish();
    } catch (const ProofFailed& failed) {
      fmt::print(log, "{}\n", failed.what());
    }
    if (!record.is_lean()) return;
    for (const auto& entry : fs::directory_iterator(at)) {
      if (!kLeanFiles.contains(entry.path().filename().string())) fs::remove_all(entry.path());
    }
  });
}

std::vector<CollectedTask> collect_tasks(const SweepFolder& folder,
                                         const std::vector<SweepTask>& tasks) {
  std::vector<CollectedTask> collected;
  for (const SweepTask& task : tasks) {
    CollectedTask one{task};
    if (is_complete(folder, task.number)) {
      const fs::path result = folder.result(task.number);
      one.state = is_proved(folder, task.number) ? TaskState::kProved : TaskState::kUnproved;
      if (one.state == TaskState::kProved) one.figures = figures_in(result);
      one.seconds = seconds_in(result);
    } else {
      one.said = last_line(folder.log(task.number));
      if (one.said.starts_with(kFailedLine)) one.state = TaskState::kFailed;
    }
    collected.push_back(std::move(one));
  }
  return collected;
}

std::vector<CollectedSite> collect_sites(const SweepFolder& folder,
                                         const std::vector<CollectedTask>& tasks,
                                         const std::vector<Site>& sites) {
  std::map<std::string, CollectedSite> classes;
  for (const CollectedTask& task : tasks) {
    CollectedSite& one = classes[task.task.value(setting::kClass)];
    ++one.tasks;
    if (!task.figures) continue;
    one.profit_sum += task.figures->profit;
    if (++one.proved > 1) continue;
    const fs::path header = folder.result(task.task.number) / run_file::kHeader;
    one.header = header.lexically_relative(folder.path).string();
  }
  std::vector<CollectedSite> collected;
  for (const Site& site : sites) {
    collected.push_back(classes[site.student]);
    collected.back().site = site;
  }
  return collected;
}

std::string tasks_csv(const std::vector<CollectedTask>& tasks) {
  constexpr const char* kStates[] = {"proved", "not proved", "failed", "missing"};
  const std::vector<std::string> names = names_in(tasks);
  std::string text = "task,state";
  for (const std::string& name : names) text.append(",").append(csv_field(name));
  for (const auto& column : kColumns) text.append(",").append(column.name);
  text += ",weights_hash,seconds\n";
  for (const CollectedTask& task : tasks) {
    text += fmt::format("{},{}", task.task.number, kStates[static_cast<std::size_t>(task.state)]);
    for (const std::string& name : names) text.append(",").append(csv_field(task.task.value(name)));
    text += task.figures ? task.figures->columns : std::string(std::size(kColumns) + 1, ',');
    text += task.seconds > 0 ? fmt::format(",{:.2f}\n", task.seconds) : std::string(",\n");
  }
  return text;
}

std::string settings_csv(const std::vector<CollectedTask>& tasks) {
  std::map<std::string, std::size_t> place;
  std::vector<FoldedSettings> rows;
  for (const CollectedTask& one : tasks) {
    const std::string key = settings_text(one.task.without_seed_and_fold());
    const auto [at, is_new] = place.try_emplace(key, rows.size());
    if (is_new) rows.push_back({&one.task});
    FoldedSettings& row = rows[at->second];
    ++row.tasks;
    if (!one.figures) continue;
    row.profits.emplace_back(one.task.value(setting::kFold), one.figures->profit);
    row.cycles += one.figures->cycles_per_day;
  }
  std::vector<std::string> names = names_in(tasks);
  std::erase(names, setting::kSeed);
  std::erase(names, setting::kFold);
  std::string text;
  for (const std::string& name : names) text += csv_field(name) + ",";
  text +=
      "tasks,proved,profit_eur_per_day_per_mwh,profit_standard_error,"
      "profit_lowest_eur_per_day_per_mwh,profit_highest_eur_per_day_per_mwh,cycles_per_day\n";
  for (const FoldedSettings& row : rows) {
    for (const std::string& name : names) text += csv_field(row.first->value(name)) + ",";
    text += fmt::format("{},{},{}\n", row.tasks, row.profits.size(), columns_of(row));
  }
  return text;
}

std::string sites_csv(const std::vector<CollectedSite>& sites) {
  std::string text =
      "id,region,class,power_w,capacity_wh,tasks,proved,profit_eur_per_day_per_mwh,"
      "profit_eur_per_day,header\n";
  for (const CollectedSite& row : sites) {
    text +=
        fmt::format("{},{},{},{},{},{},{},{},{},{}\n", csv_field(row.site.id),
                    csv_field(row.site.region), row.site.student, row.site.power_w,
                    row.site.capacity_wh, row.tasks, row.proved, error_text(row.profit(), 4, ""),
                    error_text(row.eur_per_day(), 4, ""), csv_field(row.header));
  }
  return text;
}

std::vector<PackagedClass> classes_to_package(const std::vector<CollectedTask>& tasks,
                                              const std::vector<CollectedSite>& sites,
                                              bool partial) {
  if (!tasks.empty() && !tasks.front().task.value(setting::kFold).empty())
    fail("a sweep with --folds has no student for a site: plan one without --folds");
  std::vector<PackagedClass> classes;
  std::map<std::string, std::size_t> place;
  for (const CollectedSite& site : sites) {
    const std::string& name = site.site.student;
    require_host_name(site.site.id);
    if (site.header.empty() && partial) continue;
    if (site.header.empty())
      fail("site \"{}\": none of {} tasks of its class {} is proved; skip it with --partial",
           site.site.id, site.tasks, name);
    const auto [at, is_new] = place.try_emplace(name, classes.size());
    if (is_new) classes.push_back({name, {}, {}, {}});
    classes[at->second].sites.push_back(site);
  }
  if (classes.empty())
    fail("no site has a proved student: run open tasks with bess-train sweep run");
  return classes;
}

bool package_class(const SweepFolder& sweep, const PackageRequest& request, PackagedClass& one) {
  const fs::path folder = request.out / one.name;
  const std::string header = read_file(sweep.path / one.sites.front().header);
  const bool is_due = !is_packaged(folder, header, request.architectures);
  if (is_due) {
    fs::remove_all(folder);  // never combine a header with other packages
    write_file(folder / run_file::kHeader, header);
    make_packages(request, folder, one.name);
  }
  const std::string signature =
      read_file(folder / kDecisionSignatureFile);  // "student=4d10ef93 decisions=..."
  one.student = signature.substr(signature.find('=') + 1, 8);
  one.version = version_in(folder, request.architectures.front());
  return is_due;
}

int rollout_percent(const std::string& id) {
  const auto drawn = fnv1a(id) % 100;
  return drawn < 1 ? 1 : drawn < 10 ? 10 : 100;
}

std::string format_inventory(const std::vector<PackagedClass>& classes,
                             const std::string& architecture) {
  std::string text = fmt::format(
      "# Written by bess-train sweep packages, for tools/delivery/ansible/roll_out.yml. Put "
      "addresses\n"
      "# and other bess_architecture into host_vars next to this file or into a second inventory.\n"
      "all:\n  vars: {{bess_architecture: {}}}\n  children:\n",
      architecture);
  std::map<int, std::string> shares{{1, ""}, {10, ""}, {100, ""}};
  for (const PackagedClass& one : classes) {
    text += fmt::format(
        "    class_{0}:\n      vars:\n        bess_class: \"{0}\"\n"
        "        bess_expected_student: \"{1}\"\n        bess_package: \"{{{{ inventory_dir }}}}"
        "/{0}/bess-edge_{2}_{{{{ bess_architecture }}}}.deb\"\n      hosts:\n",
        one.name, one.student, one.version);
    for (const CollectedSite& site : one.sites) {
      text += fmt::format("        \"{}\": {{bess_expected_eur_per_day: {:.4f}}}\n", site.site.id,
                          site.eur_per_day());
      shares[rollout_percent(site.site.id)] += fmt::format("        \"{}\":\n", site.site.id);
    }
  }
  for (const auto& [percent, hosts] : shares) {
    text += fmt::format("    rollout_{}:\n      hosts:{}\n{}", percent, hosts.empty() ? " {}" : "",
                        hosts);
  }
  return text;
}

}  // namespace bess
