// Is a battery as quick as its map says, for the largest step that the controller may order? Judged
// by a small step and, where SoC and limits left room, a larger one of the same direction.
//
//   both     refused only if the fit over both leaves nothing quicker possible, or the largest step
//            itself was seen to be late
//   one      refused only if it was late itself: what a larger one takes is told as a range
#pragma once

#include <cstdint>

#include "edge/base/response_band.h"
#include "edge/battery/step_fit.h"

namespace bess {

struct SpeedQuestion {
  ResponseBand response{};       ///< what the map says
  std::int32_t rated_w = 4'000;  ///< the most that is ordered
  std::int32_t step_w_max = 8'000;

  /// What the answer to such a step, half of it each way, may miss.
  [[nodiscard]] std::int32_t band_w(std::int32_t step_w) const {
    return response.tolerance_of_w(rated_w, step_w / 2);
  }
};

struct AnswerSpeed {
  bool has_two = false;      ///< steps of different size
  bool is_slow = false;      ///< slower than [response] says, surely
  bool is_doubtful = false;  ///< it may be
  StepDynamics dynamics{};   ///< without a ramp where none was seen for certain
  SecondsOfStep largest{};   ///< that the largest step takes
  /// Lines with which it would pass; 0: leave it.
  std::int32_t wanted_settle_s = 0;
  std::int32_t wanted_ramp_w_max = 0;
};

/// 0: no ramp was seen.
inline std::int32_t ramp_w_per_s(const AnswerSpeed& speed) {
  const double ramp_s_per_w = speed.dynamics.ramp_s_per_w;
  return ramp_s_per_w > 0 ? static_cast<std::int32_t>(1 / ramp_s_per_w) : 0;
}

/// `large`: null where only the small step was possible.
AnswerSpeed judge_speed(const AnswerCurve& small, const AnswerCurve* large,
                        const SpeedQuestion& question);

}  // namespace bess
