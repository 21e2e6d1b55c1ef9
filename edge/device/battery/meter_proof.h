// Meter check during commissioning: the meter follows the battery's steps. Grid = house + battery:
// between two plateaus of the battery (at rest, driven, at rest, ...) the grid power must step by
// the same amount. The permitted error is the house's variation within a plateau.
#pragma once

#include <algorithm>
#include <cstdint>

namespace bess {

enum class MeterVerdict : std::uint8_t {
  kNotAsked,  ///< no meter
  kFollows,
  kMismatch,  ///< the meter does not step with the battery
  kRestless,  ///< the house load varies more than the steps
};

class MeterProof {
 public:
  /// One settled reading of the current plateau.
  void add(std::int32_t battery_w, std::int32_t grid_w) {
    const std::int64_t house_w = std::int64_t{grid_w} - battery_w;
    if (now_.count > 0) {
      restless_w_ = std::max(
          restless_w_, std::max(house_w, house_before_w_) - std::min(house_w, house_before_w_));
    }
    house_before_w_ = house_w;
    ++now_.count;
    now_.battery_w += battery_w;
    now_.grid_w += grid_w;
  }

  /// The next order begins: the readings since the last one form a plateau.
  void end_plateau() {
    if (now_.count == 0) return;
    const Plateau plateau{
        .count = 1, .battery_w = now_.battery_w / now_.count, .grid_w = now_.grid_w / now_.count};
    if (before_.count > 0) judge(plateau);
    before_ = plateau;
    now_ = Plateau{};
  }

  /// More than half of the steps must agree: one may coincide with a house load step.
  [[nodiscard]] MeterVerdict verdict() const {
    if (steps_ == 0) return MeterVerdict::kNotAsked;
    if (2 * agreeing_ > steps_) return MeterVerdict::kFollows;
    return restless_w_ * 2 > smallest_step_w_ ? MeterVerdict::kRestless : MeterVerdict::kMismatch;
  }
  /// Share of the battery's steps shown by the meter.
  [[nodiscard]] std::int32_t percent() const {
    return squares_ == 0 ? 0 : static_cast<std::int32_t>(products_ * 100 / squares_);
  }

 private:
  struct Plateau {
    std::int64_t count = 0;
    std::int64_t battery_w = 0;
    std::int64_t grid_w = 0;
  };
  static constexpr std::int64_t kMeterErrorW = 50;

  void judge(const Plateau& now) {
    const std::int64_t battery_w = now.battery_w - before_.battery_w;
    const std::int64_t grid_w = now.grid_w - before_.grid_w;
    const std::int64_t size_w = std::max(battery_w, -battery_w);
    const std::int64_t error_w = std::max(grid_w - battery_w, battery_w - grid_w);
    ++steps_;
    smallest_step_w_ = std::min(smallest_step_w_, size_w);
    agreeing_ += error_w <= size_w / 5 + kMeterErrorW ? 1 : 0;
    products_ += grid_w * battery_w;
    squares_ += battery_w * battery_w;
  }

  Plateau now_;
  Plateau before_;
  std::int64_t house_before_w_ = 0;
  std::int64_t restless_w_ = 0;
  std::int64_t smallest_step_w_ = INT64_MAX;
  int steps_ = 0;
  int agreeing_ = 0;
  std::int64_t products_ = 0;
  std::int64_t squares_ = 0;
};

}  // namespace bess
