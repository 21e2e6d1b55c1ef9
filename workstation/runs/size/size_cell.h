// The money of one battery under one contract: what a year brings after the costs of the contract,
// and how long until it has earned its price, while it ages; the plan of sizes, and classes of
// sizes that share a policy.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "workstation/report/backtest/walk_forward.h"
#include "workstation/runs/chain/run_config.h"

namespace bess {

// What is to be weighed up before a battery is bought: powers x capacities x contracts, what buying
// costs and how it ages. A TOML file; README.md has an example with every key.

/// What trading costs, and what whoever lets one trade keeps.
struct SizeContract {
  std::string name;
  TradingCosts costs;  ///< these and the next two change what is decided
  double wear_eur_per_mwh = 0;
  double cycles_per_day_max = 0;
  double share_percent = 0;  ///< of what a month earns; of a month's loss nothing
  double fee_eur_per_month = 0;
  double capacity_eur_per_kw_year = 0;  ///< on the mean of the months' highest quarter-hours taken
  double capacity_free_kw = 0;          ///< of it, that the site pays for anyway
};

/// What a battery costs. All 0: nothing is said of paying back.
struct Purchase {
  double eur = 0, eur_per_kw = 0, eur_per_kwh = 0;

  [[nodiscard]] double price_eur(double power_w, double capacity_wh) const {
    return eur + eur_per_kw * power_w / 1e3 + eur_per_kwh * capacity_wh / 1e3;
  }
};

/// Capacity that is lost, of what was bought: so much a year in any case, and so much by use. Data
/// sheets of LFP promise 80 % after 6,000 cycles (3.3 % a thousand); with 1 % a year beside it a
/// battery of one cycle a day has 78 % after ten years, inside of the 8 to 15 years to 70 or 80 %
/// that a survey of home batteries reports (cleanenergyreviews.info, "Battery life explained").
struct Ageing {
  double calendar_percent_per_year = 1;
  double cycle_percent_per_1000 = 3.3;  ///< equivalent full cycles of the capacity bought
  double end_percent = 70;              ///< of that capacity: then it is replaced
};

struct SizePlan {
  std::vector<double> power_w, capacity_wh;
  std::vector<SizeContract> contracts;  ///< not empty
  Purchase purchase;
  Ageing ageing;
  std::string policy = "sdp";
  int window_days = 120;
};

/// `base` is the configuration that all cells have in common: what a contract does not name is as
/// there. Throws UserError naming file and line.
SizePlan read_size_plan(const std::string& path, const RunConfig& base);

// What a battery of one C-rate earns under the linear terms of a contract, walk-forward, of any
// size: profit, throughput and peaks of two batteries that differ in size alone are as their sizes,
// so a class is traded once at the size of the defaults (chain/learning_class.h).

/// Of a calendar month: the highest mean power taken from the grid in a quarter-hour, as a share of
/// the rated power.
struct MonthPeak {
  std::string month;  ///< local, "2024-08"
  double power_share;
};

struct SizeClass {
  BatteryParameters battery;
  Evaluation traded;                ///< the charge left at the end is valued
  std::vector<MonthPeak> peaks;     ///< of the traded months
  double share_of_foresight = 0.0;  ///< NaN when foresight earns nothing
};

/// What is asked of the market: days, policies by name, threads.
struct SizeTrial {
  const MarketSteps& market;
  const Folds& folds;
  std::string policy;
  int threads;
};

/// A class for each of `configs`, which are canonical. Throws UserError.
std::vector<SizeClass> trade_classes(const std::vector<RunConfig>& configs, const SizeTrial& trial);

/// Highest quarter-hour of each local month; `steps` ascending. Energy of a step that two
/// quarter-hours share is each one's by half.
std::vector<MonthPeak> month_peaks(const std::vector<StepRecord>& steps, double power_w_max);

/// All in EUR of the whole battery. Wear steers decisions and is in the profit that `evaluate`
/// tells; it is no money that leaves the account, and ageing counts it in its own way: it is in
/// `profit` alone.
struct SizeCell {
  double power_w, capacity_wh;
  const SizeContract* contract;
  std::size_t class_index;
  double profit_eur_per_day_per_mwh;  ///< net of wear, before share, fees and capacity tariff
  double margin_eur_per_year;         ///< after the share, before fees and capacity tariff
  double fixed_eur_per_year;          ///< fees and capacity tariff
  double error_eur_per_year;          ///< standard error of the year, by month; NaN of one month
  double cycles_per_day;
  double share_of_foresight;
  double price_eur;
  double life_years;      ///< until the capacity has fallen to what ends it
  double pay_back_years;  ///< NaN: not within its life, or no price
  double life_eur;        ///< what it has brought by then, less its price

  [[nodiscard]] double eur_per_year() const { return margin_eur_per_year - fixed_eur_per_year; }
  [[nodiscard]] double eur_per_kwh_year() const { return eur_per_year() / (capacity_wh / 1e3); }
  [[nodiscard]] double eur_per_cycle() const;
};

/// The cells of a plan, powers outermost, contracts innermost, and the classes that they are of.
struct SizeCells {
  std::vector<SizeCell> cells;  ///< their contracts are the plan's
  std::vector<SizeClass> classes;
};

/// The configuration of one battery under one contract.
RunConfig cell_config(const RunConfig& base, double power_w, double capacity_wh,
                      const SizeContract& contract);

/// The money of one battery of a class.
SizeCell size_cell(const SizePlan& plan, const SizeContract& contract, const SizeClass& of,
                   double power_w, double capacity_wh);

/// Throws UserError.
SizeCells weigh_up(const SizePlan& plan, const RunConfig& base, const SizeTrial& trial);

/// What the battery brings month by month until it is replaced: the margin falls with the capacity
/// that is left, the fixed costs do not.
struct LifeOfBattery {
  double years, pay_back_years, eur;
};
LifeOfBattery life_of(const SizeCell& cell, const Ageing& ageing);

/// Whoever pays back soonest; without prices, or when nobody does, who leaves most at its end or
/// brings most a year and kWh.
const SizeCell& best_of(const std::vector<SizeCell>& cells);

}  // namespace bess
