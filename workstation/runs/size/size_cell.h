// Economics of one battery under one contract: yearly earnings after contract costs, and payback
// with ageing; the plan of sizes, classes of sizes that share a policy, and the report.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/backtest/walk_forward.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// Size plan: powers x capacities x contracts, purchase costs and ageing. A TOML file;
// shared/manual/guides/which_battery.md has an example.

/// Trading costs and the aggregator's share.
struct SizeContract {
  std::string name;
  TradingCosts costs;  ///< these and the next two change decisions
  double wear_eur_per_mwh = 0;
  double cycles_per_day_max = 0;
  double share_percent = 0;  ///< of the earnings of months with a profit
  double fee_eur_per_month = 0;
  double capacity_eur_per_kw_year = 0;  ///< on the mean of the monthly import peaks (quarter-hours)
  double capacity_free_kw = 0;          ///< already paid for by the site
};

/// Purchase price. All 0: no payback is computed.
struct Purchase {
  double eur = 0, eur_per_kw = 0, eur_per_kwh = 0;

  [[nodiscard]] double price_eur(double power_w, double capacity_wh) const {
    return eur + eur_per_kw * power_w / 1e3 + eur_per_kwh * capacity_wh / 1e3;
  }
};

/// Capacity fade, % of the initial capacity, by calendar and by use. LFP data sheets state 80 %
/// after 6,000 cycles (3.3 % per 1000); with 1 % per year, a battery with one full cycle per day
/// has 78 % after ten years, within the 8 to 15 years to 70 or 80 % reported for home batteries
/// (cleanenergyreviews.info, "Battery life explained").
struct Ageing {
  double calendar_percent_per_year = 1;
  double cycle_percent_per_1000 = 3.3;  ///< full cycles of the initial capacity
  double end_percent = 70;              ///< of the initial capacity, at replacement
};

struct SizePlan {
  std::vector<double> power_w, capacity_wh;
  std::vector<SizeContract> contracts;  ///< not empty
  Purchase purchase;
  Ageing ageing;
  std::string policy = "sdp";
  int window_days = 120;
};

/// `base` is the configuration of all cells; contracts override it. Throws UserError naming file
/// and line.
SizePlan read_size_plan(const std::string& path, const RunConfig& base);

// Walk-forward results by C-rate and linear contract terms. Profit, throughput and peaks are
// proportional to size, so a class is traded once at the default size (chain/run_config.h).

/// Import peak of a calendar month: highest quarter-hour mean, as a share of the rated power.
struct MonthPeak {
  std::string month;  ///< local, "2024-08"
  double power_share;
};

struct SizeClass {
  BatteryParameters battery;
  Evaluation traded;                ///< final charge valued
  std::vector<MonthPeak> peaks;     ///< of the traded months
  double share_of_foresight = 0.0;  ///< NaN if foresight earns nothing
};

/// Common inputs of all backtests.
struct SizeBacktest {
  const MarketSteps& market;
  const Folds& folds;
  std::string policy;
  int threads;
};

/// Highest quarter-hour of each local month; `steps` ascending. A step in two quarter-hours counts
/// half in each.
std::vector<MonthPeak> month_peaks(const std::vector<StepRecord>& steps, double power_w_max);

/// In EUR for the whole battery. Wear affects decisions and `profit` only; it is not a payment, and
/// ageing accounts for it separately.
struct SizeCell {
  double power_w, capacity_wh;
  const SizeContract* contract;
  double profit_eur_per_day_per_mwh;  ///< net of wear, before share, fees and capacity tariff
  double margin_eur_per_year;         ///< after the share, before fees and capacity tariff
  double fixed_eur_per_year;          ///< fees and capacity tariff
  double error_eur_per_year;          ///< standard error per year, by month; NaN for one month
  double cycles_per_day;
  double share_of_foresight;
  double price_eur;
  double life_years = 0;      ///< until replacement
  double pay_back_years = 0;  ///< NaN: not within its lifetime, or no price
  double life_eur = 0;        ///< earnings over the lifetime less the price

  [[nodiscard]] double eur_per_year() const { return margin_eur_per_year - fixed_eur_per_year; }
  [[nodiscard]] double eur_per_kwh_year() const { return eur_per_year() / (capacity_wh / 1e3); }
  [[nodiscard]] double eur_per_cycle() const;
};

/// Cells of a plan (powers outermost, contracts innermost) and their classes.
struct SizeCells {
  std::vector<SizeCell> cells;  ///< point to the plan's contracts
  std::vector<SizeClass> classes;
};

/// Configuration of one battery under one contract.
RunConfig cell_config(const RunConfig& base, double power_w, double capacity_wh,
                      const SizeContract& contract);

/// Economics of one battery of a class.
SizeCell size_cell(const SizePlan& plan, const SizeContract& contract, const SizeClass& of,
                   double power_w, double capacity_wh);

/// Throws UserError.
SizeCells evaluate_cells(const SizePlan& plan, const RunConfig& base, const SizeBacktest& backtest);

/// Computes the lifetime and its result by month: the margin falls with the remaining capacity,
/// fixed costs do not.
void add_lifetime(SizeCell& cell, const Ageing& ageing);

/// Shortest payback; if none pays back, the highest lifetime result per EUR of price; without
/// prices, the highest yearly earnings per kWh.
const SizeCell& best_of(const std::vector<SizeCell>& cells);

// Size report: table, CSV, JSON, and a page with a heat map per contract.

struct SizeReport {
  const SizePlan& plan;
  const SizeCells& weighed;
  std::string provenance;  ///< one line: prices, policy, window
};

std::string format_size_table(const SizeReport& report);
/// Header `power_kw,capacity_kwh,contract,...`, one row per cell.
std::string size_csv(const SizeReport& report);
Json size_json(const SizeReport& report);
/// Writes size.html into `folder`.
void write_size_page(const SizeReport& report, const std::filesystem::path& folder);

}  // namespace bess
