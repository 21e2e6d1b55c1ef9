// What others would have earned with the same battery on the same prices, to hold what was earned
// against: resting, a rule, the student with nobody in its way, and foresight. All begin at the
// state of charge at which the days began; what each stores more or less at the end counts at the
// mean price, so all have the same charge at both ends.
//
// Estimates: the battery of the specification, 90 % there and back [SPEC 3], each cycle at the
// price that it was decided on; where the log has no price, all rest.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "edge/account/drive.h"
#include "edge/log/log_reader.h"
#include "shared/host/json.h"

namespace bess {

/// Of the days from `first_day` to `last_day`, as 20231126, oldest first.
std::vector<PricedCycle> priced_cycles(const LogReader& log, std::int32_t first_day,
                                       std::int32_t last_day);

struct Rivals {
  double rule_eur = 0;  ///< charges in the cheapest quarter of these prices, discharges in the
                        ///< dearest: it knows their distribution, not their order
  double student_eur =
      0;  ///< student and thresholds, without limits, holds, stops and other losses
  double foresight_eur = 0;  ///< knows every price: a bound, no rival
  std::int32_t rule_low_centi = 0;
  std::int32_t rule_high_centi = 0;
};

/// `cycles` in the order of time, `soc_frac` that before the first. All zero without cycles, or
/// where the battery has no capacity.
Rivals find_rivals(std::span<const PricedCycle> cycles, double soc_frac,
                   const BatteryParameters& battery, const PriceThresholds& thresholds);

/// `earned_eur` with the same charge at both ends. A line, ended.
std::string rivals_text(const Rivals& rivals, double earned_eur);
Json rivals_json(const Rivals& rivals, double earned_eur);

}  // namespace bess
