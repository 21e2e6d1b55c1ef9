// Profit gap to perfect foresight, split over the policy's decisions and their causes.
//
// With the day's paid prices known, Q_t(s, a) is the value of action a at step t and SoC s if all
// later decisions are optimal (ForesightPolicy::worth_eur). Along the policy's own path s_0, s_1,
// ...,
//
//   foresight - earned = sum over steps of  max_b Q_t(s_t, b) - Q_t(s_t, a_t)
//                                                       [Kakade, Langford 2002, Lemma 6.1]
//
// so the gap is a sum of non-negative regrets, one per decision: energy that an empty battery could
// not sell is charged to the decision that emptied it. Each regret is split by evaluating other
// policies at the same step and SoC, each with one constraint less:
//
//   a_0 own action    -> a_1 the plain student under the rules           the correction
//   a_1               -> a_2 the plain student                           a rule or the guard
//   a_2               -> a_3 that student, given the paid price          newest price, or outage
//   a_3               -> b   the optimum                                 later prices
//
// (After the day's full cycles are used up, all regret is due to the limit.) Part k is Q(a_k+1) -
// Q(a_k); it is negative where a constraint helped. The last part is attributed to the price of
// that moment or to a later price at which the battery was at an end of its SoC window: the one
// further from the day's median. All parts add up to the gap, including rounding by the SoC grid.
// The part of the correction is at the exported policy's own SoC, by decision; the headline's cost
// of the correction compares two whole runs.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "workstation/data/env/evaluate.h"
#include "workstation/report/figures/html.h"

namespace bess {

enum class LossCause : std::uint8_t {
  kDearMissed,   ///< discharging was optimal
  kCheapMissed,  ///< charging was optimal
  kEmpty,        ///< too little charge: empty at a higher price of the same day
  kFull,         ///< too much charge: full at a lower price of the same day
  kTiming,       ///< idle was optimal
  kNewestPrice,  ///< newest price differed from the paid price
  kOutage,       ///< the same while the newest price was late
  kRules,        ///< operator rule, in the student or the guard
  kCorrection,   ///< correction of the student
  kCycleLimit,   ///< full cycles used up, or saved for later
  kRounding,     ///< of the SoC grid
};
inline constexpr std::size_t kLossCauseCount = 11;

struct LossCauseText {
  std::string_view key;      ///< stable, for files: "dear_missed"
  std::string_view name;     ///< for output: "missed high price"
  std::string_view meaning;  ///< without a full stop
};
const LossCauseText& text_of(LossCause cause);

/// Decision with the largest loss by one cause.
struct GapMoment {
  double eur = 0;  ///< by that cause; 0: none
  MarketStep step{};
  double soc_frac = 0;
  Action done{};
  Action best{};
};

inline constexpr std::size_t kHoursPerDay = 24;

struct DayLoss {
  std::string date;
  double foresight_eur = 0;
  double earned_eur = 0;
  std::array<double, kLossCauseCount> part_eur{};  ///< by LossCause; the sum is the gap
  std::array<GapMoment, kLossCauseCount> moment{};
  std::array<double, kHoursPerDay>
      regret_eur{};  ///< by local hour, without rounding and cycle limit

  [[nodiscard]] double missed_eur() const { return foresight_eur - earned_eur; }
  [[nodiscard]] double of(LossCause cause) const {
    return part_eur[static_cast<std::size_t>(cause)];
  }
  /// Cause with the largest part.
  [[nodiscard]] LossCause main_cause() const;
};

/// Policies of the chain; null ones have no part.
struct LossChain {
  Policy& policy;                       ///< evaluated policy
  const Policy* under_rules = nullptr;  ///< the plain student under the operator's rules
  const Policy* plain = nullptr;        ///< the plain student
};

/// Day-reset accounting. A price is late when it is older than the usual age in this market.
std::vector<DayLoss> foresight_gap(const MarketSteps& market, const std::vector<MarketDay>& days,
                                   const LossChain& chain, const BatteryParameters& battery,
                                   double initial_soc_frac);

// Page section on the profit gap: by cause, by hour and month, and the
// worst days.

struct RunResults;

/// Losses of the exported policy over the test days.
std::vector<DayLoss> losses_of(const RunResults& run);

/// EUR per MWh of capacity.
std::string foresight_gap_html(const std::vector<DayLoss>& losses, double capacity_mwh);

/// Data of foresight_gap_html: lost_causes, lost_hours, lost_days (all days).
std::vector<PictureFile> foresight_gap_files(const std::vector<DayLoss>& losses,
                                             double capacity_mwh);

}  // namespace bess
