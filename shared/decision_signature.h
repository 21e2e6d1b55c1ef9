// The signature of what a student and the guard decide: both replay the same recorded prices on
// fixed days, and one number stands for all their orders. It belongs to the weights and to the code
// that decides: a change of either shows, and every machine must find the same number. The exporter
// writes it beside the header, and every build of the edge is held against it.
//
// Two days of prices are replayed in each month of a year, in spring and autumn on the days of the
// clock change; a student by outlook plans each of them on made-up day-ahead prices. The battery's
// energy is counted in integers, so nothing here rounds.
#pragma once

#include <cstdint>

#include "shared/fixed_text.h"
#include "shared/outlook/outlook_model.h"

namespace bess {

/// The paper's house battery, as its guard is set for the replay.
inline constexpr std::int32_t kReplayedPowerW = 4'000;
inline constexpr std::int32_t kReplayedSocMinE4 = 1'000;
inline constexpr std::int32_t kReplayedSocMaxE4 = 10'000;
inline constexpr std::int32_t kReplayedSocHysteresisE4 = 50;

/// What a decision of the replay is made on, at the end of the price's minute.
struct ReplayedMoment {
  std::int64_t now_utc_s;
  std::int32_t soc_e4;
  std::int32_t context_centi;  ///< level or break-even price, whichever is the student's context
  std::int32_t price_centi_eur_per_mwh;
};

/// Student and guard.
class ReplayedDecider {
 public:
  /// Charging is positive.
  virtual std::int32_t power_w(const ReplayedMoment& moment) = 0;

 protected:
  ~ReplayedDecider() = default;
};

struct DecisionSignature {
  std::uint64_t signature = 0;  ///< over (UTC seconds, ordered W) of every decision, in order
  int decisions = 0;
  int charging = 0;
  int discharging = 0;
};

/// `outlook`: of a student by outlook, else null. Takes a fraction of a second, by outlook some
/// 1.5 s on a PC. The time zone must be set.
DecisionSignature replay_recorded_days(ReplayedDecider& decider, const OutlookModel* outlook);

/// As `bess-edge signature` prints it and decision_signature.txt holds it.
FixedText<127> signature_line(std::uint32_t student_hash, const DecisionSignature& found);

}  // namespace bess
