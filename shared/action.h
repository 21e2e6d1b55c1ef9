// Actions of the paper, a in {-P, 0, +P}, and the argmax with its tie rule [SPEC 3, 5]: ties go to
// the lowest action (discharge < idle < charge), only here.
#pragma once

#include <cstdint>
#include <string_view>

namespace bess {

enum class Action : std::int8_t { kDischarge = 0, kIdle = 1, kCharge = 2 };
inline constexpr int kActionCount = 3;

/// Power as a multiple of the rated power: -1 discharge, 0 idle, +1 charge.
constexpr int power_sign(Action action) { return static_cast<int>(action) - 1; }

constexpr std::string_view action_name(Action action) {
  constexpr std::string_view kNames[kActionCount] = {"discharge", "idle", "charge"};
  return kNames[static_cast<int>(action)];
}

/// Action with the largest value; `value` is ordered discharge, idle, charge.
template <typename T>
constexpr Action argmax_action(const T* value) {
  int best = 0;
  for (int i = 1; i < kActionCount; ++i) {
    if (value[i] > value[best]) best = i;  // strictly greater: ties go to the lowest action
  }
  return static_cast<Action>(best);
}

}  // namespace bess
