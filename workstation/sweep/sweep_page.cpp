#include "workstation/sweep/sweep_page.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/figures/page_files.h"
#include "workstation/report/figures/sort_table.h"
#include "workstation/report/report_page.h"
#include "workstation/sweep/heat_map.h"

namespace bess {
namespace {

Cell optional_cell(const std::optional<double>& value, int decimals) {
  return number_cell(value.value_or(std::nan("")), decimals);
}

Cell with_error(double value, const std::optional<double>& error) {
  return number_cell(
      error ? fmt::format("{:.1f} \u00b1 {:.1f}", value, *error) : fmt::format("{:.1f}", value),
      value);
}

Cell setting_cell(const Entries& settings, const std::string& name) {
  const auto found = std::ranges::find(settings, name, &Entries::value_type::first);
  if (found == settings.end()) return {kNoValue};
  return {html_escaped(found->second), found->second};
}

SortTable settings_table(const std::vector<FoldedSettings>& rows,
                         const std::vector<std::string>& names) {
  SortTable table{"settings", "Settings, seeds and months folded", {"Settings"}, {}};
  table.header.insert(table.header.end(), names.begin(), names.end());
  table.header.insert(table.header.end(),
                      {"Tasks", "Proved", "Profit", "Lowest", "Highest", "Cycles a day"});
  int number = 0;
  for (const FoldedSettings& row : rows) {
    ++number;
    std::vector<Cell> cells{{fmt::format("{}", number), fmt::format("{}", number)}};
    for (const std::string& name : names) cells.push_back(setting_cell(row.settings, name));
    cells.push_back(number_cell(row.tasks, 0));
    cells.push_back(number_cell(row.proved, 0));
    if (row.proved > 0) {
      cells.push_back(with_error(row.mean, row.standard_error));
      cells.push_back(number_cell(row.low, 1));
      cells.push_back(number_cell(row.high, 1));
      cells.push_back(number_cell(row.cycles_per_day, 2));
    } else {
      cells.resize(cells.size() + 4, Cell{kNoValue});
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

SortTable task_table(const std::vector<CollectedTask>& tasks,
                     const std::vector<std::string>& names) {
  SortTable table{"tasks", "Every task", {"Task"}, {}};
  table.header.insert(table.header.end(), names.begin(), names.end());
  table.header.insert(table.header.end(),
                      {"State", "Days", "Profit", "Over the rule", "At wear 10",
                       "Same charge each day", "Cycles a day", "% of foresight", "Weights"});
  for (const CollectedTask& task : tasks) {
    const std::string number = fmt::format("{}", task.task.number);
    std::vector<Cell> cells{{number, number}};
    for (const std::string& name : names) cells.push_back(setting_cell(task.task.settings, name));
    cells.push_back(text_cell(state_name(task.state)));
    if (const auto& f = task.figures) {
      const auto share = f->share_of_foresight;
      cells.insert(
          cells.end(),
          {number_cell(f->days, 0), with_error(f->profit, f->standard_error),
           optional_cell(f->gain, 1), number_cell(f->profit_at_wear_10, 1),
           number_cell(f->profit_day_reset, 1), number_cell(f->cycles_per_day, 2),
           number_cell(share ? 100 * *share : std::nan(""), 1), text_cell(f->weights_hash)});
    } else {
      cells.resize(cells.size() + 7, Cell{kNoValue});
      cells.push_back(no_text_cell());
    }
    table.rows.push_back(std::move(cells));
  }
  return table;
}

SortTable site_table(const std::vector<CollectedSite>& sites) {
  SortTable table{"sites",
                  "Sites",
                  {"Site", "Region", "Student", "Power, kW", "Capacity, kWh", "Profit",
                   "EUR/day, whole battery"},
                  {}};
  for (const CollectedSite& row : sites) {
    table.rows.push_back({text_cell(row.site.id), text_cell(row.site.region),
                          text_cell(row.site.student), number_cell(row.site.power_w / 1e3, 1),
                          number_cell(row.site.capacity_wh / 1e3, 1), optional_cell(row.profit, 1),
                          optional_cell(row.eur_per_day, 2)});
  }
  return table;
}

Json cycles_chart(const std::vector<CollectedTask>& tasks) {
  Json points = Json::list();
  for (const CollectedTask& task : tasks) {
    if (!task.figures) continue;
    Json point = Json::list();
    point.add(task.figures->cycles_per_day);
    point.add(task.figures->profit);
    point.add(fmt::format("task {}: {}", task.task.number, settings_shown(task.task.settings)));
    points.add(std::move(point));
  }
  Json chart = Json::object({{"id", "cycles"}, {"kind", "dots"}});
  chart.set("x", "equivalent full cycles a day");
  chart.set("y", "EUR per day per MWh");
  chart.set("points", std::move(points));
  return chart;
}

/// Of the map: what was asked for, or the first two that vary.
std::vector<std::string> map_axes(std::vector<std::string> asked,
                                  const std::vector<std::string>& varying) {
  for (const std::string& name : asked) {
    if (std::ranges::find(varying, name) != varying.end()) continue;
    fail("--map: \"{}\" does not vary here; what does: {}", one_line(name, 60),
         varying.empty() ? "nothing" : fmt::format("{}", fmt::join(varying, ", ")));
  }
  if (asked.empty())
    asked.assign(varying.begin(),
                 varying.begin() + std::min<std::ptrdiff_t>(2, std::ssize(varying)));
  asked.resize(2);
  return asked;
}

std::string counts_text(const std::vector<CollectedTask>& tasks) {
  const auto count = [&](TaskState state) {
    return std::ranges::count(tasks, state, &CollectedTask::state);
  };
  std::string text = fmt::format("{} proved, {} not proved", count(TaskState::kProved),
                                 count(TaskState::kUnproved));
  const auto holes = count(TaskState::kFailed) + count(TaskState::kMissing);
  if (holes > 0) text += fmt::format(", <strong>{} without a result</strong>", holes);
  return text;
}

}  // namespace

std::string sweep_page(const SweepRecord& record, const std::vector<CollectedTask>& tasks,
                       const std::vector<CollectedSite>& sites, std::vector<std::string> axes) {
  const std::vector<std::string> varying = varying_settings(tasks);
  std::vector<std::string> shown = varying;  // of settings: without what is folded
  std::erase_if(shown, [](const std::string& name) {
    return name == setting::kSeed || name == setting::kFold;
  });
  const std::vector<FoldedSettings> folded = fold_seeds(tasks);
  const std::vector<std::string> map = map_axes(std::move(axes), shown);
  std::string body = fmt::format(
      "<h1>Sweep of {}</h1>\n<p>{}. Prices: {} ({}).</p>\n<p class=\"note\">EUR per day per MWh of "
      "capacity on test days, the charge carried over from day to day. \u00b1: standard error; of "
      "settings over months, or over seeds where there is one month; of a task over its days. A "
      "head sorts by its column, once more the other way round; what is not known comes "
      "last.</p>\n",
      counted(tasks.size(), "task"), counts_text(tasks), html_escaped(record.prices_name),
      html_escaped(record.prices));
  if (!map[0].empty()) {
    body += "<h2>Heat map</h2>\n" + heat_map_html(folded, map[0], map[1]);
  }
  body += "<h2>Settings</h2>\n" + sort_table_html(settings_table(folded, shown));
  Json charts = Json::list();
  charts.add(cycles_chart(tasks));
  body +=
      "<h2>Profit against cycles</h2>\n" +
      chart_html("cycles", "Profit against cycles of each proved task; the table has the numbers") +
      "<p class=\"note\">A dot a proved task: higher at the same place earns more for the same "
      "wear.</p>\n";
  if (!sites.empty()) body += "<h2>Sites</h2>\n" + sort_table_html(site_table(sites));
  body += "<h2>Tasks</h2>\n" + sort_table_html(task_table(tasks, varying));
  body += fmt::format("<p class=\"note\">{}</p>\n<script>\n{}</script>\n",
                      html_escaped(record.program), page_file("sort.js"));
  return format_chart_page(fmt::format("Sweep of {}", counted(tasks.size(), "task")), body,
                           std::move(charts));
}

}  // namespace bess
