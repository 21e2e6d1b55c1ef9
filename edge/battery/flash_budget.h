// How often registers in flash memory may still be written today. Flash endures some 100,000
// writes: a controller that writes every two minutes would use that up within months.
#pragma once

#include <cstdint>

#include "edge/registers/battery_command.h"

namespace bess {

class FlashBudget {
 public:
  explicit FlashBudget(const WritePolicy& policy) : policy_(policy) {}

  /// What an earlier process of the same day has used up.
  void restore(std::int64_t day, std::int32_t writes) {
    day_ = day;
    writes_ = writes;
  }
  /// Orders leave the reserve untouched: one release is always possible.
  [[nodiscard]] bool allows(std::int64_t day, std::int32_t writes) const {
    if (policy_.eeprom_writes_per_day == 0 || writes == 0) return true;
    const std::int32_t used = day == day_ ? writes_ : 0;
    return used + writes <= policy_.eeprom_writes_per_day - policy_.reserve;
  }
  /// Even the reserve is used up: by releases that a device does not take, tried every cycle.
  [[nodiscard]] bool is_spent(std::int64_t day) const {
    return policy_.eeprom_writes_per_day > 0 && writes_on(day) >= policy_.eeprom_writes_per_day;
  }
  void count(std::int64_t day) {
    if (day != day_) writes_ = 0;
    day_ = day;
    ++writes_;
  }
  [[nodiscard]] std::int32_t writes_on(std::int64_t day) const { return day == day_ ? writes_ : 0; }

 private:
  WritePolicy policy_;
  std::int64_t day_ = 0;
  std::int32_t writes_ = 0;
};

}  // namespace bess
