// bess-hil trial: the loss table of the trial week.
#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <cstdio>
#include <memory>

#include "shared/host/file.h"
#include "shared/host/html_text.h"
#include "shared/host/json.h"
#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "tools/battery_sim/battery_file.h"
#include "tools/hil_runner/base/stop_request.h"
#include "tools/hil_runner/run/hil_command.h"
#include "tools/hil_runner/run/report_page.h"
#include "tools/hil_runner/run/trial_week.h"

namespace bess {
namespace {

struct TrialOptions {
  std::string prices;
  std::string battery;
  TrialHouse house;
  std::string report;
  int weeks = 8;
  bool json = false;
};

double mean_per_day(const std::vector<TrialWeek>& weeks, auto&& eur_of) {
  double sum = 0;
  for (const TrialWeek& week : weeks) sum += eur_of(week);
  return sum / static_cast<double>(weeks.size()) / kTrialDays;
}

std::string table(const std::vector<TrialWeek>& weeks) {
  std::string text = fmt::format("{:12} {:>9} {:>9} {:>8}\n", "", "EUR/day", "loss %", "+-");
  text += fmt::format("{:12} {:9.3f}\n", "plain",
                      mean_per_day(weeks, [](const TrialWeek& w) { return w.plain_eur; }));
  for (std::size_t i = 0; i < disturbances().size(); ++i) {
    const TrialLoss loss = loss_of(weeks, i);
    text += fmt::format("{:12} {:9.3f} {:9.2f} {:8.2f}  {}\n", disturbances()[i].name,
                        mean_per_day(weeks, [i](const TrialWeek& w) { return w.loop_eur[i]; }),
                        loss.percent, loss.percent_error, disturbances()[i].text);
  }
  return text;
}

/// Each week's own, so that the trials of two students can be paired.
Json by_week(const std::vector<TrialWeek>& weeks, auto&& eur_of) {
  Json eur = Json::list();
  for (const TrialWeek& week : weeks) eur.add(Decimals{eur_of(week), 4});
  return eur;
}

Json json_of(const std::vector<TrialWeek>& weeks) {
  Json rows = Json::list();
  for (std::size_t i = 0; i < disturbances().size(); ++i) {
    const TrialLoss loss = loss_of(weeks, i);
    rows.add(Json::object(
        {{"name", disturbances()[i].name},
         {"eur_per_day",
          Decimals{mean_per_day(weeks, [i](const TrialWeek& w) { return w.loop_eur[i]; }), 4}},
         {"eur_by_week", by_week(weeks, [i](const TrialWeek& w) { return w.loop_eur[i]; })},
         {"loss_percent", Decimals{loss.percent, 3}},
         {"standard_error_percent", Decimals{loss.percent_error, 3}}}));
  }
  return Json::object(
      {{"weeks", weeks.size()},
       {"days_a_week", kTrialDays},
       {"plain_eur_per_day",
        Decimals{mean_per_day(weeks, [](const TrialWeek& w) { return w.plain_eur; }), 4}},
       {"plain_eur_by_week", by_week(weeks, [](const TrialWeek& w) { return w.plain_eur; })},
       {"loop", std::move(rows)}});
}

/// After the first two seconds, to a terminal alone.
void tell_progress(std::chrono::steady_clock::time_point begin, int done, int all) {
  const double s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
  if (s < 2 || isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr, "\rweek {} of {}, {:.1f} s a week, {:.0f} s left   ", done, all, s / done,
             s / done * (all - done));
  if (done == all) fmt::print(stderr, "\n");
}

BatteryParameters battery_of(const TrialOptions& options) {
  BatteryParameters battery = paper_house();
  if (options.battery.empty()) return battery;
  read_battery_file(options.battery, battery);
  const BatteryParameters house = paper_house();
  if (battery.power_w_max == house.power_w_max && battery.capacity_wh == house.capacity_wh) {
    return battery;
  }
  fail("{}: the trial is of a battery of {:g} W and {:g} Wh: set power_w and capacity_wh so",
       options.battery, house.power_w_max, house.capacity_wh);
}

void run(const TrialOptions& options) {
  if (!options.report.empty()) require_writable(options.report);
  watch_for_stop();
  const MinuteSeries prices = read_minute_file(options.prices);
  TrialHouse house = options.house;
  house.physics = battery_of(options);
  const auto begin = std::chrono::steady_clock::now();
  const std::vector<TrialWeek> weeks = run_trial(
      prices, options.weeks, house, [&](int done, int all) { tell_progress(begin, done, all); });
  const std::string text = fmt::format(
      "{} weeks of {} days from {}, house battery of 4 kW and 8 kWh; loss against the plain "
      "simulation,\nin percent of it, with the standard error of the paired difference\n{}{}",
      weeks.size(), kTrialDays, utc_text(weeks.front().start_utc_s).view(),
      house.physics.cold.exist() ? "cold are its own hours alone, all through, for both\n" : "",
      table(weeks));
  fmt::print("{}", options.json ? json_of(weeks).line() + "\n" : text);
  if (!options.report.empty()) {
    write_file(
        options.report,
        html_page(
            "The trial week",
            "<div class=\"picture\"><pre>" + html_escaped(text) +
                "</pre></div>\n<h2>Four hours, everything on</h2>\n<div class=\"picture\">" +
                trial_picture(prices, house) +
                "</div>\n<p>Measured power of each minute in the colour of its order: blue charge, "
                "orange discharge, grey none.</p>\n"));
  }
  for (const TrialWeek& week : weeks) {
    if (week.findings.empty()) continue;
    const Finding& f = week.findings.front();
    fail("an invariant does not hold: {}: expected {}, seen {}, at {}", f.rule, f.expected, f.seen,
         utc_text(f.utc_s).view());
  }
}

}  // namespace

void add_trial_command(ProgramCommand& app) {
  auto options = std::make_shared<TrialOptions>();
  ProgramCommand command =
      app.subcommand("trial", "What the loop costs against plain simulation, over weeks of prices");
  command.footer(
      "Examples:\n"
      "  bess-hil trial --prices tests/data/benchmark_minutes_2023.csv.gz\n"
      "  bess-hil trial --prices mine.csv.gz --battery house.toml\n"
      "  bess-hil trial --prices mine.csv.gz --guard 'stand_in_s_max = 1800' --outage-min 15\n"
      "  bess-hil trial --prices mine.csv.gz --weeks 12 --report trial.html");
  command.option("--prices", options->prices, "Minute file, CSV or .csv.gz").required();
  command.option("--weeks", options->weeks, "Of eight days each").range(1, 1'000).with_default();
  command.option("--battery", options->battery,
                 "[battery] of this file, for loop and simulation alike (bess-train battery fit)");
  command.option("--guard", options->house.edge_guard,
                 "Lines of [guard] for the loop, e.g. 'stand_in_s_max = 3600'");
  command.option("--outage-min", options->house.outage_min, "Of outages: how long")
      .range(1, 1'440)
      .with_default();
  command.option("--outage-every-min", options->house.outage_every_min, "Of outages: one in each")
      .range(15, 11'520)
      .with_default();
  command.option("--report", options->report, "Write table and picture here (HTML)");
  command.flag("--json", options->json, "One JSON object instead of the table");
  command.runs([options] { run(*options); });
}

}  // namespace bess
