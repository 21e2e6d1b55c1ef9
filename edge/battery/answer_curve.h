// How a battery came to the power that it was ordered: readings since the order, of which follow
// how long nothing showed (lag), how fast it rose (ramp) and until when it was not there yet. A
// reading takes a while, and the program may have been held up within it: what is said to be slow
// was slow however the reading lay within its time.
#pragma once

#include <algorithm>
#include <cstdint>

#include "edge/base/static_vector.h"

namespace bess {

struct AnswerReading {
  std::int64_t begin_ms = 0;  ///< since the order was in force
  std::int64_t end_ms = 0;
  std::int32_t along_w = 0;  ///< positive: the way it was ordered
};

class AnswerCurve {
 public:
  /// `ordered_w` above 0; within `band_w` of it the power has come.
  AnswerCurve(std::int32_t ordered_w, std::int32_t band_w)
      : ordered_w_(ordered_w), band_w_(band_w) {}

  /// More than fit are left out: the first ones tell of lag and ramp, and `outside_until_ms` goes
  /// on.
  void add(const AnswerReading& reading) {
    if (!is_within(reading.along_w)) {
      outside_until_ms_ = reading.begin_ms;
      came_ms_ = -1;
    } else if (came_ms_ < 0) {
      came_ms_ = reading.end_ms;
    }
    static_cast<void>(readings_.try_push_back(reading));
  }

  /// The last instant at which the power was certainly outside its band.
  [[nodiscard]] std::int64_t outside_until_ms() const { return outside_until_ms_; }
  [[nodiscard]] bool has_come() const { return came_ms_ >= 0; }
  /// When it was first seen inside for good; -1: never.
  [[nodiscard]] std::int64_t came_ms() const { return came_ms_; }

  /// Until anything showed, at least; 0: at once.
  [[nodiscard]] std::int64_t lag_ms() const {
    std::int64_t lag_ms = 0;
    for (const AnswerReading& r : readings_) {
      if (r.along_w * 10 >= ordered_w_) return lag_ms;
      lag_ms = r.begin_ms;
    }
    return lag_ms;
  }

  /// At most, by the readings on the way, three or more; 0: too fast to be seen.
  [[nodiscard]] std::int32_t ramp_w_per_s() const {
    const AnswerReading* first = nullptr;
    const AnswerReading* last = nullptr;
    int count = 0;
    for (const AnswerReading& r : readings_) {
      if (r.along_w * 10 < ordered_w_) continue;
      if (r.along_w * 10 > ordered_w_ * 9 || (last != nullptr && r.along_w <= last->along_w)) break;
      if (first == nullptr) first = &r;
      last = &r;
      ++count;
    }
    if (count < kReadingsOfRamp || last->begin_ms <= first->end_ms) return 0;
    const std::int64_t rise_w = last->along_w - first->along_w;
    return static_cast<std::int32_t>(
        std::max<std::int64_t>(rise_w * 1'000 / (last->begin_ms - first->end_ms), 1));
  }

 private:
  static constexpr int kReadingsOfRamp = 3;

  [[nodiscard]] bool is_within(std::int32_t along_w) const {
    return along_w >= ordered_w_ - band_w_ && along_w <= ordered_w_ + band_w_;
  }

  std::int32_t ordered_w_;
  std::int32_t band_w_;
  StaticVector<AnswerReading, 256> readings_;
  std::int64_t outside_until_ms_ = 0;
  std::int64_t came_ms_ = -1;
};

}  // namespace bess
