#include "workstation/runs/size/size_cell.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/toml_reader.h"
#include "shared/host/user_error.h"
#include "workstation/base/answer.h"
#include "workstation/base/parallel_for.h"
#include "workstation/base/progress.h"
#include "workstation/data/env/evaluate.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/policy/planners/baselines.h"
#include "workstation/report/figures/html.h"
#include "workstation/runs/chain/policy_factory.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

namespace {

constexpr double kKiloMin = 0.01;
constexpr double kKiloMax = 1e6;
constexpr std::size_t kCellsMax = 10'000;

/// A list of kW or kWh as W or Wh.
std::vector<double> read_kilos(TomlTable& table, std::string_view key) {
  table.require(key);
  std::vector<double> sizes;
  const TomlArray* list = table.array(key);
  if (list == nullptr) return sizes;
  for (const TomlValue& value : *list) {
    const double kilos = value.number().value_or(0);
    if (!(kilos >= kKiloMin && kilos <= kKiloMax)) {
      table.fail_at(value, std::string(key) + ": expected numbers from 0.01 to 1000000");
    } else if (std::ranges::find(sizes, kilos * 1e3) != sizes.end()) {
      table.fail_at(value, std::string(key) + ": a value is repeated");
    }
    sizes.push_back(kilos * 1e3);
  }
  if (list->empty()) table.fail(key, "is empty: add at least one value");
  return sizes;
}

SizeContract as_configured(const RunConfig& base) {
  SizeContract contract{.name = "as configured", .costs = base.battery.costs};
  contract.wear_eur_per_mwh = base.battery.wear_eur_per_mwh;
  contract.cycles_per_day_max = base.battery.cycles_per_day_max;
  return contract;
}

SizeContract read_contract(TomlTable& table, const RunConfig& base) {
  SizeContract contract = as_configured(base);
  table.require("name");
  table.line("name", contract.name);
  table.number("import_adder_eur_per_mwh", contract.costs.import_adder_eur_per_mwh, 0, 1000);
  table.number("import_percent", contract.costs.import_percent, 0, 100);
  table.number("export_fee_eur_per_mwh", contract.costs.export_fee_eur_per_mwh, 0, 1000);
  table.number("export_percent", contract.costs.export_percent, 0, 100);
  table.number("wear_eur_per_mwh", contract.wear_eur_per_mwh, 0, 1000);
  table.number("cycles_per_day_max", contract.cycles_per_day_max, 0, 1000);
  table.number("share_percent", contract.share_percent, 0, 100);
  table.number("fee_eur_per_month", contract.fee_eur_per_month, 0, 1e6);
  table.number("capacity_eur_per_kw_year", contract.capacity_eur_per_kw_year, 0, 10'000);
  table.number("capacity_free_kw", contract.capacity_free_kw, 0, kKiloMax);
  table.finish();
  return contract;
}

void read_contracts(TomlTable& top, const RunConfig& base, SizePlan& plan) {
  const TomlArray* list = top.has("contract") ? top.array("contract") : nullptr;
  if (list == nullptr) return plan.contracts.push_back(as_configured(base));
  for (const TomlValue& value : *list) {
    TomlTable table(&value, top.file(), "[[contract]]", top.error());
    plan.contracts.push_back(read_contract(table, base));
    const auto same =
        std::ranges::count(plan.contracts, plan.contracts.back().name, &SizeContract::name);
    if (same > 1) top.fail_at(value, "[[contract]]: this name is used twice");
  }
}

void read_purchase(TomlTable& top, SizePlan& plan) {
  TomlTable purchase(top.table("purchase"), top.file(), "[purchase]", top.error());
  purchase.number("eur", plan.purchase.eur, 0, 1e9);
  purchase.number("eur_per_kw", plan.purchase.eur_per_kw, 0, 1e5);
  purchase.number("eur_per_kwh", plan.purchase.eur_per_kwh, 0, 1e5);
  purchase.finish();
  TomlTable ageing(top.table("ageing"), top.file(), "[ageing]", top.error());
  ageing.number("calendar_percent_per_year", plan.ageing.calendar_percent_per_year, 0, 50);
  ageing.number("cycle_percent_per_1000", plan.ageing.cycle_percent_per_1000, 0, 100);
  ageing.number("end_percent", plan.ageing.end_percent, 1, 99);
  ageing.finish();
}

/// Traded days, as days of the whole market.
std::vector<MarketDay> traded_days(const MarketSteps& market, const Evaluation& traded) {
  std::vector<MarketDay> days;
  auto next = traded.days.begin();
  for (const MarketDay& day : market.days) {
    if (next == traded.days.end() || next->date != day.date()) continue;
    days.push_back(day);
    ++next;
  }
  return days;
}

SizeClass trade_class(const RunConfig& config, const SizeBacktest& backtest) {
  const FoldPolicy make = [&](const Fold& fold) {
    return make_policy(backtest.policy, fold.market, config.battery);
  };
  std::vector<StepRecord> steps;
  WalkForward walked = walk_forward(backtest.policy, backtest.folds, make, config.battery,
                                    config.initial_soc_frac, backtest.market, false, &steps);
  // One plan over the whole series, as in walk_forward() for each month.
  const MarketSteps& market = backtest.market;
  const auto foresight = make_baseline(kForesightName, market, config.battery);
  const double bound = evaluate_carried_over(market, traded_days(market, walked.total), *foresight,
                                             config.battery, config.initial_soc_frac)
                           .profit_eur_per_day_per_mwh();
  const double profit = walked.total.profit_eur_per_day_per_mwh();
  return {config.battery, std::move(walked.total), month_peaks(steps, config.battery.power_w_max),
          bound > 0 ? profit / bound : NAN};
}

/// One class for each of the canonical `configs`. Throws UserError.
std::vector<SizeClass> trade_classes(const std::vector<RunConfig>& configs,
                                     const SizeBacktest& backtest) {
  std::vector<SizeClass> classes(configs.size());
  Progress progress("size", "classes", static_cast<double>(configs.size()));
  parallel_for(configs.size(), backtest.threads, [&](std::size_t c) {
    classes[c] = trade_class(configs[c], backtest);
    progress.advance();
  });
  return classes;
}

constexpr double kDaysPerYear = 365.25;
constexpr int kMonthsPerYear = 12;
constexpr int kLifeMonthsMax = 50 * kMonthsPerYear;

/// Daily cash: profit without wear, less the share of months with a profit.
std::vector<DayValue> cash_of(const SizeClass& of, double share_percent) {
  std::vector<DayValue> days;
  std::map<std::string, double> months;
  for (const DayResult& day : of.traded.days) {
    const double eur = day.profit_eur + of.traded.wear_eur_per_mwh * day.throughput_mwh;
    days.emplace_back(day.date, eur);
    months[day.date.substr(0, 7)] += eur;
  }
  for (auto& [date, eur] : days) {
    if (months[date.substr(0, 7)] > 0) eur *= 1 - share_percent / 100;
  }
  return days;
}

double fixed_costs(const SizeContract& contract, const SizeClass& of, double power_w) {
  double kw = 0;
  for (const MonthPeak& peak : of.peaks) {
    kw += peak.power_share * power_w / 1e3 / static_cast<double>(of.peaks.size());
  }
  return kMonthsPerYear * contract.fee_eur_per_month +
         contract.capacity_eur_per_kw_year * std::max(0.0, kw - contract.capacity_free_kw);
}

std::vector<Column<SizeCell>> columns() {
  using C = SizeCell;
  return {
      {{"power_kw", "kW", "", kAllDecimals, "kW"}, [](const C& c) { return c.power_w / 1e3; }},
      {{"capacity_kwh", "kWh", "", kAllDecimals, "kWh"},
       [](const C& c) { return c.capacity_wh / 1e3; }},
      {{"contract", "contract", "", 0, "Contract"}, [](const C& c) { return c.contract->name; }},
      {{"year_eur", "EUR/year", "{:.0f}", 4, "EUR of this battery per year"}, &C::eur_per_year},
      {{"year_standard_error_by_month", "s.e.", "{:.0f}", 4, "s.e. by month, EUR/year"},
       &C::error_eur_per_year},
      {{"fixed_eur_per_year", "fixed", "{:.0f}", 4, "Fees, capacity, EUR/year"},
       &C::fixed_eur_per_year},
      {{"year_eur_per_kwh", "per kWh", "{:.1f}", 4, "EUR/year/kWh of capacity"},
       &C::eur_per_kwh_year},
      {{"cycle_eur", "per cycle", "{:.2f}", 4, "EUR per full cycle"}, &C::eur_per_cycle},
      {{"cycles_per_day", "cycles", "{:.2f}", 4, "Full cycles/day"}, &C::cycles_per_day},
      {{key::kShareOfForesight, "foresight", "{:.3f}", 4, "Share of foresight"},
       &C::share_of_foresight},
      {{"price_eur", "price", "{:.0f}", 4, "Price, EUR"}, &C::price_eur},
      {{"pay_back_years", "pay-back", "{:.1f}", 4, "Payback, years"}, &C::pay_back_years},
      {{"life_years", "life", "{:.1f}", 4, "Lifetime, years"}, &C::life_years},
      {{"life_eur", "at end", "{:.0f}", 4, "Lifetime result, EUR"}, &C::life_eur},
      {{key::kProfit, "", "{:.4f}", 4, "EUR/day/MWh of capacity, net of wear"},
       &C::profit_eur_per_day_per_mwh},
  };
}

Table table_of(const SizeReport& report) { return {columns(), report.weighed.cells}; }

std::string kilo(double value) { return fmt::format("{:g}", value / 1e3); }

std::string best_text(const SizeCells& weighed) {
  const SizeCell& best = best_of(weighed.cells);
  const std::string what =
      std::isnan(best.pay_back_years)
          ? std::string("none pays back; best lifetime result per EUR of price")
          : fmt::format("shortest payback, {:.1f} years", best.pay_back_years);
  return fmt::format("{}: {} kW, {} kWh, {}",
                     best.price_eur > 0 ? what : "highest yearly earnings per kWh",
                     kilo(best.power_w), kilo(best.capacity_wh), best.contract->name);
}

/// Heat map points of a contract.
std::vector<HeatPoint> points_of(const SizeReport& report, const SizeContract& contract,
                                 HeatValue (*value)(const SizeCell&)) {
  std::vector<HeatPoint> points;
  for (const SizeCell& cell : report.weighed.cells) {
    if (cell.contract != &contract) continue;
    points.push_back({kilo(cell.power_w), kilo(cell.capacity_wh), value(cell)});
  }
  return points;
}

std::string maps_html(const SizeReport& report) {
  std::string text;
  int number = 0;
  for (const SizeContract& contract : report.plan.contracts) {
    const auto map = [&](const char* what, HeatValue (*value)(const SizeCell&)) {
      text += heat_map_html(points_of(report, contract, value),
                            {"kW", "kWh", what, fmt::format("map-{}", ++number)});
    };
    text += fmt::format("<h2>{}</h2>\n", html_escaped(contract.name));
    map("EUR per year per kWh of capacity", [](const SizeCell& c) -> HeatValue {
      return {c.eur_per_kwh_year(), c.error_eur_per_year / (c.capacity_wh / 1e3)};
    });
    if (report.weighed.cells.front().price_eur > 0) {
      map("Payback, years", [](const SizeCell& c) -> HeatValue {  // error: first order
        return {c.pay_back_years, c.pay_back_years * c.error_eur_per_year / c.eur_per_year()};
      });
    }
  }
  return text;
}

}  // namespace

SizePlan read_size_plan(const std::string& path, const RunConfig& base) {
  TomlValue document;
  std::string error;
  if (!parse_toml_text(read_file(path, kTomlBytesMax), path, document, error)) {
    throw UserError(error);
  }
  SizePlan plan;
  TomlTable top(&document, path, "", error);
  top.require("size");
  TomlTable size(top.table("size"), path, "[size]", error);
  plan.power_w = read_kilos(size, "power_kw");
  plan.capacity_wh = read_kilos(size, "capacity_kwh");
  size.integer("window_days", plan.window_days, 30, 3650);
  size.line("policy", plan.policy);
  size.finish();
  read_contracts(top, base, plan);
  read_purchase(top, plan);
  top.finish();
  if (!error.empty()) throw UserError(error);
  const std::size_t cells = plan.power_w.size() * plan.capacity_wh.size() * plan.contracts.size();
  if (cells > kCellsMax)
    fail("{}: {} cells exceed the maximum of {}; use fewer values", path, cells, kCellsMax);
  return plan;
}

std::vector<MonthPeak> month_peaks(const std::vector<StepRecord>& steps, double power_w_max) {
  std::map<std::int64_t, double> watt_minutes;  // imported, by quarter-hour
  for (const StepRecord& step : steps) {
    for (int minute = 0; minute < kMinutesPerStep; ++minute) {
      watt_minutes[(step.utc_s + 60 * minute) / kSecondsPerQuarterHour] +=
          std::max(step.power_w, 0.0);
    }
  }
  std::vector<MonthPeak> peaks;
  for (const auto& [quarter_hour, sum] : watt_minutes) {
    const std::string month =
        format_local_date(local_date_of(quarter_hour * kSecondsPerQuarterHour)).substr(0, 7);
    if (peaks.empty() || peaks.back().month != month) peaks.push_back({month, 0});
    const double share = sum / kMinutesPerQuarterHour / power_w_max;
    peaks.back().power_share = std::max(peaks.back().power_share, share);
  }
  return peaks;
}

double SizeCell::eur_per_cycle() const { return eur_per_year() / (cycles_per_day * kDaysPerYear); }

RunConfig cell_config(const RunConfig& base, double power_w, double capacity_wh,
                      const SizeContract& contract) {
  RunConfig config = base;
  config.battery.power_w_max = power_w;
  config.battery.capacity_wh = capacity_wh;
  config.battery.costs = contract.costs;
  config.battery.wear_eur_per_mwh = contract.wear_eur_per_mwh;
  config.battery.cycles_per_day_max = contract.cycles_per_day_max;
  return config;
}

SizeCells evaluate_cells(const SizePlan& plan, const RunConfig& base,
                         const SizeBacktest& backtest) {
  struct Place {
    double power_w, capacity_wh;
    const SizeContract& contract;
    std::size_t class_index;
  };
  std::vector<Place> places;
  std::vector<RunConfig> configs;
  std::map<std::string, std::size_t> by_key;
  for (const double power_w : plan.power_w) {
    for (const double capacity_wh : plan.capacity_wh) {
      for (const SizeContract& contract : plan.contracts) {
        const RunConfig own = cell_config(base, power_w, capacity_wh, contract);
        require_consistent(own, "[[contract]] " + contract.name);
        const RunConfig config = canonical(own);
        const auto [at, is_new] = by_key.try_emplace(learning_key(config, ""), configs.size());
        if (is_new) configs.push_back(config);
        places.push_back({power_w, capacity_wh, contract, at->second});
      }
    }
  }
  SizeCells all{{}, trade_classes(configs, backtest)};
  for (const auto& [power_w, capacity_wh, contract, class_index] : places) {
    all.cells.push_back(size_cell(plan, contract, all.classes[class_index], power_w, capacity_wh));
  }
  return all;
}

SizeCell size_cell(const SizePlan& plan, const SizeContract& contract, const SizeClass& of,
                   double power_w, double capacity_wh) {
  const std::vector<DayValue> cash = cash_of(of, contract.share_percent);
  const double days_of_cell = kDaysPerYear * capacity_wh / of.battery.capacity_wh;
  SizeCell cell{.power_w = power_w,
                .capacity_wh = capacity_wh,
                .contract = &contract,
                .profit_eur_per_day_per_mwh = of.traded.profit_eur_per_day_per_mwh(),
                .margin_eur_per_year = mean_of(cash) * days_of_cell,
                .fixed_eur_per_year = fixed_costs(contract, of, power_w),
                .error_eur_per_year = day_errors(cash).by_month * days_of_cell,
                .cycles_per_day = of.traded.cycles_per_day(),
                .share_of_foresight = of.share_of_foresight,
                .price_eur = plan.purchase.price_eur(power_w, capacity_wh)};
  add_lifetime(cell, plan.ageing);
  return cell;
}

void add_lifetime(SizeCell& cell, const Ageing& ageing) {
  cell.life_years = 0;
  cell.pay_back_years = NAN;
  cell.life_eur = -cell.price_eur;
  double capacity = 1;  // of the initial capacity
  const double cycles = cell.cycles_per_day * kDaysPerYear / kMonthsPerYear;
  for (int month = 0; month < kLifeMonthsMax && capacity > ageing.end_percent / 100; ++month) {
    const double eur =
        (cell.margin_eur_per_year * capacity - cell.fixed_eur_per_year) / kMonthsPerYear;
    if (cell.life_eur < 0 && cell.life_eur + eur >= 0) {
      cell.pay_back_years = (month - cell.life_eur / eur) / kMonthsPerYear;
    }
    cell.life_eur += eur;
    cell.life_years = (month + 1.0) / kMonthsPerYear;
    capacity -= ageing.calendar_percent_per_year / 100 / kMonthsPerYear +
                ageing.cycle_percent_per_1000 / 100 * cycles * capacity / 1000;
  }
}

const SizeCell& best_of(const std::vector<SizeCell>& cells) {
  const auto rank = [](const SizeCell& cell) {
    const bool pays = !std::isnan(cell.pay_back_years);
    const double otherwise =
        cell.price_eur > 0 ? cell.life_eur / cell.price_eur : cell.eur_per_kwh_year();
    return std::pair(pays, pays ? -cell.pay_back_years : otherwise);
  };
  return *std::ranges::max_element(cells, {}, rank);
}

std::string format_size_table(const SizeReport& report) {
  return fmt::format("{}\n{}{}\n", report.provenance, table_of(report).text(),
                     best_text(report.weighed));
}

std::string size_csv(const SizeReport& report) { return table_of(report).csv(); }

Json size_json(const SizeReport& report) {
  const Evaluation& traded = report.weighed.classes.front().traded;
  return answer("size", {{"policy", report.plan.policy},
                         {"window_days", report.plan.window_days},
                         {"days", traded.days.size()},
                         {"months", traded.errors().months},
                         {"classes", report.weighed.classes.size()},
                         {"cells", table_of(report).json()}});
}

void write_size_page(const SizeReport& report, const std::filesystem::path& folder) {
  const Evaluation& traded = report.weighed.classes.front().traded;
  const Ageing& ageing = report.plan.ageing;
  const std::string body = fmt::format(
      "<h1>Battery size and contract</h1>\n<p>{}. {}.</p>\n<p class=\"note\">Yearly values from "
      "the {} from {} to {}; each month is traded by a policy fitted on the days before it; after "
      "the contract's costs, share, fees and capacity tariff. Ageing: {:g} % per year and {:g} % "
      "per 1000 full cycles, to {:g} % of the capacity; the margin falls with it. By month: "
      "standard error with each month as one sample. Maps: {}. {}</p>\n{}<h2>All "
      "batteries</h2>\n{}<script>\n{}</script>\n",
      html_escaped(report.provenance), html_escaped(best_text(report.weighed)),
      counted(traded.days.size(), "day"), traded.days.front().date, traded.days.back().date,
      ageing.calendar_percent_per_year, ageing.cycle_percent_per_1000, ageing.end_percent,
      kShadeMeaning, csv_link("size.csv"), maps_html(report),
      sort_table_html(sort_table("cells", "All batteries", table_of(report))),
      page_file("sort.js"));
  write_file(folder / "size.html",
             format_chart_page("Battery size and contract", body, Json::list()));
}

}  // namespace bess
