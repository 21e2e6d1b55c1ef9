// How much energy had flowed by when, for as long as a state of charge may be old: a reading of it
// tells of some instant within a window that ends now, and the energy of that instant lies between
// the least and the most of it.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace bess {

/// In watt-seconds, charging positive.
struct EnergyRange {
  std::int64_t least_ws = 0;
  std::int64_t most_ws = 0;

  /// From an instant of `before` to one of this.
  [[nodiscard]] constexpr EnergyRange since(const EnergyRange& before) const {
    return {least_ws - before.most_ws, most_ws - before.least_ws};
  }
  /// That flowed whichever the instants were, with its sign; 0: it may have been none.
  [[nodiscard]] constexpr std::int64_t surely_ws() const {
    return least_ws > 0 ? least_ws : std::min<std::int64_t>(most_ws, 0);
  }
};

class EnergyPath {
 public:
  static constexpr std::size_t kPoints =
      64;  ///< two for each reading and each cut; a window is 620 s at most

  /// What flowed before is not known.
  void begin(std::int64_t steady_s) {
    count_ = 0;
    push({steady_s, newest().energy_ws});
  }
  /// `power_w` since the point before.
  void add(std::int64_t steady_s, std::int32_t power_w) {
    const std::int64_t seconds = std::max<std::int64_t>(steady_s - newest().steady_s, 0);
    if (seconds == 0) return;
    push({steady_s, newest().energy_ws + std::int64_t{power_w} * seconds});
  }
  [[nodiscard]] std::int64_t energy_ws() const { return newest().energy_ws; }

  /// Between then and now. What is not remembered went at most at `power_w_max`, either way.
  [[nodiscard]] EnergyRange since(std::int64_t from_s, std::int32_t power_w_max) const {
    EnergyRange range{newest().energy_ws, newest().energy_ws};
    const auto include = [&range](std::int64_t energy_ws) {
      range.least_ws = std::min(range.least_ws, energy_ws);
      range.most_ws = std::max(range.most_ws, energy_ws);
    };
    for (std::size_t i = 1; i < count_; ++i) {
      const Point& later = back(i - 1);
      const Point& earlier = back(i);
      if (later.steady_s <= from_s) return range;
      const std::int64_t seconds = later.steady_s - earlier.steady_s;
      const std::int64_t left_s = std::max(from_s, earlier.steady_s) - earlier.steady_s;
      include(earlier.energy_ws + (later.energy_ws - earlier.energy_ws) * left_s / seconds);
    }
    const std::int64_t forgotten_s = std::max<std::int64_t>(back(count_ - 1).steady_s - from_s, 0);
    const std::int64_t oldest_ws = back(count_ - 1).energy_ws;
    include(oldest_ws - power_w_max * forgotten_s);
    include(oldest_ws + power_w_max * forgotten_s);
    return range;
  }

 private:
  struct Point {
    std::int64_t steady_s = 0;
    std::int64_t energy_ws = 0;
  };

  void push(const Point& point) {
    next_ = (next_ + 1) % kPoints;
    points_[next_] = point;
    count_ = std::min(count_ + 1, kPoints);
  }
  /// 0 is the newest.
  [[nodiscard]] const Point& back(std::size_t i) const {
    return points_[(next_ + kPoints - i) % kPoints];
  }
  [[nodiscard]] const Point& newest() const { return points_[next_]; }

  std::array<Point, kPoints> points_{};
  std::size_t next_ = 0;
  std::size_t count_ = 1;
};

}  // namespace bess
