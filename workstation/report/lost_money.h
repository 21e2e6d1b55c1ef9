// Where a day lost money, and why: what perfect foresight would have earned more, split over the
// policy's own decisions and over their causes.
//
// Idea. With the day's paid prices known, Q_t(s, a) is what action a is worth at step t and SoC s
// when all later decisions are the best ones (ForesightPolicy::worth_eur). Along the way s_0, s_1,
// ... that the policy really went,
//
//   foresight - earned = sum over steps of  max_b Q_t(s_t, b) - Q_t(s_t, a_t)
//                                                       [Kakade, Langford 2002, Lemma 6.1]
//
// so what was missed is a sum of regrets, none negative, each of one decision: what an empty
// battery could not sell is charged to the decision that emptied it. Each regret is then split by
// asking others at the same step and SoC, each with one fetter less:
//
//   a_0 what was done -> a_1 the plain student under the rules           the correction
//   a_1               -> a_2 the plain student                           a rule or the guard
//   a_2               -> a_3 that student, shown the price that is paid  newest price, or none came
//   a_3               -> b   the best                                    what later prices bring
//
// (Once the day's cycles are used up there is nothing to ask: all of it is the limit's.) Part k is
// Q(a_k+1) - Q(a_k); it may be negative, where a fetter helped. The last part is named by which
// price is to blame, the one of that moment or a later one of the day at which the battery stood at
// an end of its window: of the two the one that lies further from the day's median. All parts add
// up to what was missed; the rounding of the bound's SoC grid is one of them. The correction's part
// is counted at the exported policy's own SoC, decision by decision: the headline's price of the
// correction compares two whole runs.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "workstation/data/env/evaluate.h"

namespace bess {

enum class LossCause : std::uint8_t {
  kDearMissed,   ///< selling was best, and it did not sell
  kCheapMissed,  ///< buying was best, and it did not buy
  kEmpty,        ///< it kept or bought too little: empty at a dearer moment of the same day
  kFull,         ///< it kept or bought too much: full at a cheaper moment of the same day
  kTiming,       ///< it sold or bought where resting was best
  kNewestPrice,  ///< the newest price was far from the one that was paid
  kOutage,       ///< the same while prices failed to come: the newest is older than it should be
  kRules,        ///< an operator's rule, in the student or the guard
  kCorrection,   ///< the student was made to keep the properties
  kCycleLimit,   ///< the day's cycles were used up, or worth saving
  kRounding,     ///< of the bound's grid
};
inline constexpr std::size_t kLossCauseCount = 11;

/// Stable word for files: "dear_missed".
std::string_view loss_cause_key(LossCause cause);
/// For people: "dear moment missed".
std::string_view loss_cause_name(LossCause cause);
/// What it says, in a sentence without its full stop.
std::string_view loss_cause_meaning(LossCause cause);

/// The decision that lost most by one cause.
struct LossMoment {
  double eur = 0;  ///< by that cause; 0: there is none
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
  std::array<double, kLossCauseCount> part_eur{};  ///< by LossCause; their sum is what was missed
  std::array<LossMoment, kLossCauseCount> moment{};
  std::array<double, kHoursPerDay>
      regret_eur{};  ///< by local hour: without rounding and limit of cycles

  [[nodiscard]] double missed_eur() const { return foresight_eur - earned_eur; }
  [[nodiscard]] double of(LossCause cause) const {
    return part_eur[static_cast<std::size_t>(cause)];
  }
  /// The largest part.
  [[nodiscard]] LossCause main_cause() const;
};

/// Who is asked; what is null is not asked, and has no part.
struct LossChain {
  Policy& policy;                       ///< whose money it is
  const Policy* under_rules = nullptr;  ///< the plain student under the operator's rules
  const Policy* plain = nullptr;        ///< the plain student
};

/// Each day from the same SoC. A price is late when it is older than the youngest of the market.
std::vector<DayLoss> lost_money(const MarketSteps& market, const std::vector<MarketDay>& days,
                                const LossChain& chain, const BatteryParameters& battery,
                                double initial_soc_frac);

}  // namespace bess
