// The money of one battery under one contract: what a year brings after all that the contract
// takes, and how long it takes to bring what the battery cost, while that ages.
#pragma once

#include <cstddef>
#include <vector>

#include "workstation/size/size_class.h"

namespace bess {

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
