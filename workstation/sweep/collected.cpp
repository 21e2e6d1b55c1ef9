#include "workstation/sweep/collected.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "workstation/run/run_folder.h"
#include "workstation/run/run_record.h"
#include "workstation/run/run_summary.h"
#include "workstation/sweep/own_rate.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

std::optional<double> number_or_none(const CsvTable& table, std::size_t row, const char* column) {
  const std::size_t at = table.column(column);
  if (table.text(row, at).empty()) return std::nullopt;
  return table.number(row, at);
}

/// The exported student's two rows of a run's table.
TaskFigures figures_in(const fs::path& result) {
  const std::string name = (result / run_file::kTable).string();
  const CsvTable table = CsvTable::read(name);
  const std::size_t policy = table.column("policy");
  const std::size_t carry = table.column("carry_soc");
  const std::size_t profit = table.column("profit_eur_per_day_per_mwh");
  TaskFigures figures;
  int found = 0;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    if (table.text(row, policy) != kExportedPolicy) continue;
    ++found;
    if (table.text(row, carry) != "true") {
      figures.profit_day_reset = table.number(row, profit);
      continue;
    }
    figures.profit = table.number(row, profit);
    figures.standard_error = number_or_none(table, row, "profit_standard_error");
    figures.standard_error_by_month = number_or_none(table, row, "profit_standard_error_by_month");
    figures.gain = number_or_none(table, row, "gain_eur_per_day_per_mwh");
    figures.profit_at_wear_10 =
        table.number(row, table.column("profit_at_wear_10_eur_per_day_per_mwh"));
    figures.cycles_per_day = table.number(row, table.column("cycles_per_day"));
    figures.share_of_foresight = number_or_none(table, row, "share_of_foresight");
    figures.days = static_cast<int>(table.number(row, table.column("days")));
  }
  if (found != 2) fail("{}: has no two rows of the {}", name, kExportedPolicy);
  const std::string record = (result / run_file::kRecord).string();
  const Json json = Json::parse(read_file(record));
  figures.weights_hash = json.value()["figures"]["weights_hash"].text_or("");
  if (figures.weights_hash.empty()) fail("{}: tells no weights' hash", record);
  return figures;
}

double seconds_in(const fs::path& result) {
  const fs::path path = result / run_file::kTimes;
  if (!fs::exists(path)) return 0;
  double seconds = 0;
  const Json json = Json::parse(read_file(path));
  for (const JsonValue stage : json.value()) seconds += stage["seconds"].number().value_or(0);
  return seconds;
}

Entries without_seed_and_fold(const Entries& settings) {
  Entries kept = settings;
  std::erase_if(kept, [](const auto& entry) {
    return entry.first == setting::kSeed || entry.first == setting::kFold;
  });
  return kept;
}

struct Moments {
  double mean = 0;
  std::optional<double> standard_error;
};
Moments moments_of(const std::vector<double>& values) {
  const auto n = static_cast<double>(values.size());
  Moments moments;
  for (const double v : values) moments.mean += v / n;
  if (values.size() < 2) return moments;
  double squares = 0;
  for (const double v : values) squares += (v - moments.mean) * (v - moments.mean);
  moments.standard_error = std::sqrt(squares / (n - 1) / n);
  return moments;
}

/// What folding sees of the proved tasks of one settings.
struct Folded {
  FoldedSettings row;
  std::map<std::string, std::vector<double>> by_month;  ///< one month without folds
  double cycles = 0;
};

FoldedSettings finished(Folded& folded) {
  FoldedSettings& row = folded.row;
  if (row.proved == 0) return row;
  std::vector<double> months;
  for (const auto& [month, profits] : folded.by_month) months.push_back(moments_of(profits).mean);
  const Moments over =
      months.size() > 1 ? moments_of(months) : moments_of(folded.by_month.begin()->second);
  row.mean = over.mean;
  row.standard_error = over.standard_error;
  row.cycles_per_day = folded.cycles / row.proved;
  return row;
}

std::string optional_text(const std::optional<double>& value, int decimals) {
  return value ? fmt::format("{:.{}f}", *value, decimals) : std::string();
}

}  // namespace

std::string state_name(TaskState state) {
  switch (state) {
    case TaskState::kProved:
      return "proved";
    case TaskState::kUnproved:
      return "not proved";
    case TaskState::kFailed:
      return "failed";
    case TaskState::kMissing:
      break;
  }
  return "missing";
}

std::vector<CollectedTask> collect_tasks(const SweepFolder& folder,
                                         const std::vector<SweepTask>& tasks,
                                         const std::vector<TaskState>& states) {
  std::vector<CollectedTask> collected;
  collected.reserve(tasks.size());
  for (std::size_t t = 0; t < tasks.size(); ++t) {
    CollectedTask one{tasks[t], states[t], {}, 0};
    const fs::path result = folder.result(tasks[t].number);
    const bool is_done = one.state == TaskState::kProved || one.state == TaskState::kUnproved;
    if (one.state == TaskState::kProved) one.figures = figures_in(result);
    if (is_done) one.seconds = seconds_in(result);
    collected.push_back(std::move(one));
  }
  return collected;
}

double mean_seconds(const SweepFolder& folder, const std::vector<TaskState>& states) {
  constexpr int kAsked = 100;
  double sum = 0;
  int count = 0;
  for (std::size_t t = 0; t < states.size() && count < kAsked; ++t) {
    if (states[t] != TaskState::kProved && states[t] != TaskState::kUnproved) continue;
    sum += seconds_in(folder.result(static_cast<int>(t) + 1));
    ++count;
  }
  return count == 0 ? 0 : sum / count;
}

std::vector<FoldedSettings> fold_seeds(const std::vector<CollectedTask>& tasks) {
  std::map<std::string, std::size_t> place;
  std::vector<Folded> folded;
  for (const CollectedTask& task : tasks) {
    const Entries settings = without_seed_and_fold(task.task.settings);
    const auto [at, is_new] = place.try_emplace(settings_text(settings), folded.size());
    if (is_new) folded.emplace_back().row.settings = settings;
    Folded& into = folded[at->second];
    ++into.row.tasks;
    if (!task.figures) continue;
    const double profit = task.figures->profit;
    into.row.low = into.row.proved == 0 ? profit : std::min(into.row.low, profit);
    into.row.high = into.row.proved == 0 ? profit : std::max(into.row.high, profit);
    ++into.row.proved;
    into.cycles += task.figures->cycles_per_day;
    into.by_month[task.task.value(setting::kFold)].push_back(profit);
  }
  std::vector<FoldedSettings> rows;
  for (Folded& one : folded) rows.push_back(finished(one));
  return rows;
}

std::vector<CollectedSite> collect_sites(const SweepFolder& folder,
                                         const std::vector<CollectedTask>& tasks,
                                         const std::vector<Site>& sites) {
  struct Class {
    int tasks = 0, proved = 0;
    double sum = 0;
    const CollectedTask* first = nullptr;  ///< proved
  };
  std::map<std::string, Class> classes;
  for (const CollectedTask& task : tasks) {
    Class& one = classes[task.task.value(setting::kClass)];
    ++one.tasks;
    if (!task.figures) continue;
    ++one.proved;
    one.sum += task.figures->profit;
    if (one.first == nullptr) one.first = &task;
  }
  OwnRates rates(folder);
  std::vector<CollectedSite> collected;
  for (const Site& site : sites) {
    const Class& one = classes[site.student];
    CollectedSite row{site, one.tasks, one.proved, {}, {}, {}, {}, {}};
    if (one.first != nullptr) {
      const fs::path result = folder.result(one.first->task.number);
      row.header = (result / run_file::kHeader).lexically_relative(folder.path).string();
      row.profit = one.sum / one.proved;
      if (const auto own = rates.earned(*one.first, site)) {
        row.profit_at_own_rate = own->profit;
        row.rounding_loss_at_most = own->loss_at_most;
      }
      row.eur_per_day = row.profit_at_own_rate.value_or(*row.profit) * site.capacity_wh / 1e6;
    }
    collected.push_back(std::move(row));
  }
  return collected;
}

std::vector<std::string> varying_settings(const std::vector<CollectedTask>& tasks) {
  struct Seen {
    std::string first;
    std::size_t tasks = 0;
    bool differs = false;
  };
  std::vector<std::string> order;
  std::map<std::string, Seen> seen;
  for (const CollectedTask& task : tasks) {
    for (const auto& [name, value] : task.task.settings) {
      const auto [at, is_new] = seen.try_emplace(name, Seen{value});
      if (is_new) order.push_back(name);
      ++at->second.tasks;
      at->second.differs = at->second.differs || at->second.first != value;
    }
  }
  std::erase_if(order, [&](const std::string& name) {
    return !seen[name].differs && seen[name].tasks == tasks.size();
  });
  return order;
}

std::string tasks_csv(const std::vector<CollectedTask>& tasks) {
  std::vector<std::string> names;
  for (const CollectedTask& task : tasks) {
    for (const auto& [name, value] : task.task.settings) {
      if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    }
  }
  std::string text = "task,state";
  for (const std::string& name : names) text.append(",").append(csv_field(name));
  text +=
      ",days,profit_eur_per_day_per_mwh,profit_standard_error,profit_standard_error_by_month,"
      "gain_eur_per_day_per_mwh,profit_at_wear_10_eur_per_day_per_mwh,"
      "profit_day_reset_eur_per_day_per_mwh,cycles_per_day,share_of_foresight,weights_hash,"
      "seconds\n";
  for (const CollectedTask& task : tasks) {
    text += fmt::format("{},{}", task.task.number, state_name(task.state));
    for (const std::string& name : names) text.append(",").append(csv_field(task.task.value(name)));
    if (const auto& f = task.figures) {
      text += fmt::format(",{},{:.4f},{},{},{},{:.4f},{:.4f},{:.4f},{},{}", f->days, f->profit,
                          optional_text(f->standard_error, 4),
                          optional_text(f->standard_error_by_month, 4), optional_text(f->gain, 4),
                          f->profit_at_wear_10, f->profit_day_reset, f->cycles_per_day,
                          optional_text(f->share_of_foresight, 6), f->weights_hash);
    } else {
      text += ",,,,,,,,,,";
    }
    text += task.seconds > 0 ? fmt::format(",{:.2f}\n", task.seconds) : std::string(",\n");
  }
  return text;
}

std::string sites_csv(const std::vector<CollectedSite>& sites) {
  std::string text =
      "id,region,class,power_w,capacity_wh,tasks,proved,profit_eur_per_day_per_mwh,"
      "profit_eur_per_day,header,profit_at_own_rate_eur_per_day_per_mwh,"
      "rounding_loss_at_most_eur_per_day_per_mwh\n";
  for (const CollectedSite& row : sites) {
    text += fmt::format(
        "{},{},{},{},{},{},{},{},{},{},{},{}\n", csv_field(row.site.id), csv_field(row.site.region),
        row.site.student, row.site.power_w, row.site.capacity_wh, row.tasks, row.proved,
        optional_text(row.profit, 4), optional_text(row.eur_per_day, 4), csv_field(row.header),
        optional_text(row.profit_at_own_rate, 4), optional_text(row.rounding_loss_at_most, 4));
  }
  return text;
}

}  // namespace bess
