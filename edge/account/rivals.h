// What others would have earned with the same battery, to hold what was earned against: resting, a
// rule, the student with nobody in its way, and foresight. All begin at the state of charge at
// which the days began, decide in the cycles of the log on the price that the controller had there,
// and are paid as it was: by quarter-hours, at the settled price where it is published, less what
// the contract takes. Where the log has no price, all rest.
//
// Two figures of each: what was paid, and the same with what it stores more at the end than at the
// beginning sold at the mean price, or what is missing bought. They are those of `bess-train
// evaluate --carry-soc`, before and behind its charge left. Told in comparison.h.
#pragma once

#include <cstdint>
#include <map>
#include <span>
#include <vector>

#include "edge/account/drive.h"
#include "edge/account/period.h"
#include "edge/log/log_reader.h"

namespace bess {

/// The cycles that the others trade in.
struct LoggedMarket {
  std::vector<PricedCycle> cycles;  ///< oldest first; a time that a stepped clock gave twice once
  int decided = 0;                  ///< by the student of the time
  int decided_otherwise = 0;        ///< of them, than this program's would have
};

/// Of those days; a price older than `price_age_s_max` is none, but what stood in for it is one.
LoggedMarket logged_market(const LogReader& log, const Period& period, const QuarterPrices& prices,
                           std::int32_t price_age_s_max);

/// Charges below, discharges above.
struct QuartileRule {
  std::int32_t low_centi = 0;
  std::int32_t high_centi = 0;
  int days =
      0;  ///< before, whose prices these are quartiles of; 0: those that the student learnt on
};
/// By the prices that the 30 days before `first_day` were decided on, of which the log must hold a
/// week: what the rule trades it has not seen.
QuartileRule quartile_rule(const LogReader& log, std::int32_t first_day);

struct Rival {
  double paid_eur = 0;
  double at_equal_charge_eur = 0;
  std::map<std::int32_t, double> by_day{};  ///< the second of both, as 20231126
};

struct Rivals {
  Rival rule;
  Rival student;    ///< with its rules and thresholds, without limits, holds, stops, other losses
  Rival foresight;  ///< knows every price: the most in either figure, a bound and no rival
};

/// `soc_frac` before the first cycle. All zero without cycles, or where the battery has no
/// capacity.
Rivals find_rivals(std::span<const PricedCycle> cycles, double soc_frac,
                   const BatteryParameters& battery, const PriceThresholds& thresholds,
                   const QuartileRule& rule, double mean_eur_per_mwh);

}  // namespace bess
