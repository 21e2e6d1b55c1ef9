// Decision signature: checksum of all orders of student and guard on recorded prices of fixed days.
// It detects changes of weights and decision code, and must be equal on all machines. The exporter
// writes it next to the header, and every build of the edge is compared with it.
//
// Replays two days of prices in each month of a year, including the clock changes; a student with
// context outlook plans them on synthetic day-ahead prices. Energy is an integer, without rounding.
#pragma once

#include <cstdint>

#include "shared/fixed_text.h"
#include "shared/outlook/outlook_model.h"

namespace bess {

/// Guard settings of the replay: house battery of the paper.
inline constexpr std::int32_t kReplayedPowerW = 4'000;
inline constexpr std::int32_t kReplayedSocMinE4 = 1'000;
inline constexpr std::int32_t kReplayedSocMaxE4 = 10'000;
inline constexpr std::int32_t kReplayedSocHysteresisE4 = 50;

/// Inputs of a replayed decision, at the end of the minute of the price.
struct ReplayedMoment {
  std::int64_t now_utc_s;
  std::int32_t soc_e4;
  std::int32_t context_centi;  ///< level or break-even price, by the student's context
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

/// `outlook`: null without context outlook. Takes a fraction of a second, with outlook about 1.5 s
/// on a PC. The time zone must be set.
DecisionSignature replay_recorded_days(ReplayedDecider& decider, const OutlookModel* outlook);

/// Line of `bess-edge signature` and of decision_signature.txt.
FixedText<127> signature_line(std::uint32_t student_hash, const DecisionSignature& found);

}  // namespace bess
