// A device whose counter stands still shows frozen values as if they were new: the map's `alive`.
#pragma once

#include <cstdint>

#include "edge/registers/live_points.h"
#include "shared/scaled_clock.h"

namespace bess {

class AliveWatch {
 public:
  /// `map` must outlive this object.
  explicit AliveWatch(const RegisterMap& map) : map_(map) {}

  /// To be called after each reading; true as well where the map names no counter. `now_ns` is the
  /// device's time.
  bool is_alive(const LivePoints& live, std::int64_t now_ns) {
    if (map_.alive.point < 0) return true;
    std::int64_t counter = 0;
    if (!live_value(map_, live, map_.alive.point, counter)) return false;
    if (moved_ns_ == 0 || counter != counter_) moved_ns_ = now_ns;
    counter_ = counter;
    return now_ns - moved_ns_ <= map_.alive.max_age_s * kNanosecondsPerSecond;
  }

 private:
  const RegisterMap& map_;
  std::int64_t moved_ns_ = 0;  ///< when the counter last moved; 0 = it was never read
  std::int64_t counter_ = 0;
};

}  // namespace bess
