// Weeks of prices drawn in integers, identical on every machine: one row per minute with outages,
// day-ahead prices that arrive in time, late, partly or never, and a SoC for each decision.
// Workstation and edge are compared with one golden file, which shows their equality also on
// machines without the workstation.
#pragma once

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <map>
#include <string>
#include <utility>
#include <vector>

#include "shared/action.h"
#include "shared/crc32.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

struct DrawnAnswer {
  std::int64_t received_utc_s;
  std::int64_t first_utc_s;         ///< of its quarter-hours
  std::vector<std::int32_t> centi;  ///< by quarter-hour
};

struct OutlookInputs {
  static constexpr std::int32_t kNoRow = INT32_MIN;
  std::int64_t start_utc_s, end_utc_s;  ///< local midnights
  std::vector<std::int32_t> minute_centi{};
  std::vector<DrawnAnswer> answers{};  ///< by time of arrival; each once

  [[nodiscard]] static std::int32_t soc_e4(std::int64_t tick_utc_s) {
    return static_cast<std::int32_t>(tick_utc_s / kSecondsPerStep * 2'654'435'761 % 9'001) + 1'000;
  }
};

class OutlookDraw {
 public:
  /// From local midnight to local midnight.
  OutlookDraw(const CivilTime& from, const CivilTime& until)
      : inputs_{utc_from_local(from), utc_from_local(until)} {
    std::int64_t midnight = inputs_.start_utc_s;
    while (midnight < inputs_.end_utc_s) midnight = draw_day(midnight);
  }
  [[nodiscard]] const OutlookInputs& inputs() const { return inputs_; }

 private:
  int below(int bound) {
    state_ = state_ * 6'364'136'223'846'793'005 + 1'442'695'040'888'963'407;
    return static_cast<int>((state_ >> 33) % static_cast<unsigned>(bound));
  }
  /// Of the day before, at this minute of its clock.
  static std::int64_t day_before_at(std::int64_t midnight, int minute) {
    const LocalMinute before = local_minute_of(midnight - 3 * 3'600);
    return utc_from_local({before.year, before.month, before.day, minute / 60, minute % 60, 0});
  }
  std::int64_t draw_day(std::int64_t midnight) {
    const LocalMinute day = local_minute_of(midnight + 30 * 3'600);
    const std::int64_t next = utc_from_local({day.year, day.month, day.day, 0, 0, 0});
    std::vector<std::int32_t> ahead;
    const int height = 4'000 + below(9'000);
    for (std::int64_t t = midnight; t < next; t += kSecondsPerQuarterHour) {
      const int hour = local_minute_of(t).minute_of_day / 60;
      const int peak = hour == 8 || (hour >= 18 && hour < 21) ? 9'000
                       : hour >= 11 && hour < 16              ? -6'000
                                                              : 0;
      ahead.push_back(height + peak + below(2'000));
    }
    draw_answer(midnight, ahead);
    draw_minutes(midnight, next, ahead);
    return next;
  }
  void draw_answer(std::int64_t midnight, const std::vector<std::int32_t>& ahead) {
    const int outcome = below(9);
    if (outcome == 0) return;  // a lost day
    const int minute = outcome == 1 ? 14 * 60 + below(500) : 12 * 60 + 40 + below(19);
    const std::int64_t received = day_before_at(midnight, minute);
    if (outcome != 2) {
      inputs_.answers.push_back({received, midnight, ahead});
      return;
    }
    // Partly, and complete some hours later.
    inputs_.answers.push_back({received, midnight, {ahead.begin(), ahead.begin() + 40}});
    inputs_.answers.push_back({received + 14'400, midnight, ahead});
  }
  void draw_minutes(std::int64_t midnight, std::int64_t next,
                    const std::vector<std::int32_t>& ahead) {
    for (std::int64_t t = midnight; t < next; t += 60) {
      if (t % 86'400 == 0) outage_min_ = below(4) == 0 ? 30 + below(600) : 0;
      walk_ += below(1'401) - 700 - walk_ / 60;
      if (below(400) == 0) walk_ += below(2) == 0 ? 60'000 : -40'000;
      const auto q = static_cast<std::size_t>((t - midnight) / kSecondsPerQuarterHour);
      const bool is_out = outage_min_ > 0 && outage_min_-- > 0;
      inputs_.minute_centi.push_back(is_out ? OutlookInputs::kNoRow : ahead[q] + walk_);
    }
  }

  OutlookInputs inputs_;
  std::uint64_t state_ = 20'261'125;
  int walk_ = 0;
  int outage_min_ = 0;
};

/// A checksum of each local day's decisions, and their number. The first is left out: its price
/// sets the level, so no plan can exist.
class DecisionDigest {
 public:
  void add(std::int64_t utc_s, std::int32_t break_even_centi, int context_class, Action action) {
    if (std::exchange(is_first_, false)) return;
    const LocalMinute local = local_minute_of(utc_s);
    Day& day = days_[(local.year * 100 + local.month) * 100 + local.day];
    day.crc.add_integer(utc_s);
    day.crc.add_integer(break_even_centi);
    day.crc.add_integer(context_class);
    day.crc.add_integer(static_cast<int>(action));
    ++day.decisions;
  }
  /// "20250330 690 0123abcd".
  [[nodiscard]] std::vector<std::string> lines() const {
    std::vector<std::string> lines;
    for (const auto& [date, day] : days_) {
      char text[64];
      std::snprintf(text, sizeof text, "%d %d %08x", date, day.decisions, day.crc.value());
      lines.emplace_back(text);
    }
    return lines;
  }

 private:
  struct Day {
    Crc32 crc;
    int decisions = 0;
  };
  std::map<int, Day> days_;
  bool is_first_ = true;
};

inline std::string outlook_golden_path() {
  return BESS_SOURCE_DIR "/tests/data/golden/outlook_decisions.txt";
}
/// Its lines except the first, which describes the generator.
inline std::vector<std::string> outlook_golden_lines() {
  std::ifstream file(outlook_golden_path());
  std::vector<std::string> lines;
  for (std::string line; std::getline(file, line);) {
    if (!line.starts_with('#')) lines.push_back(line);
  }
  return lines;
}

/// Two weeks around the beginning of summer time, and three months around its end.
inline OutlookInputs drawn_weeks() {
  return OutlookDraw({2025, 3, 24, 0, 0, 0}, {2025, 4, 7, 0, 0, 0}).inputs();
}
inline OutlookInputs drawn_months() {
  return OutlookDraw({2025, 9, 1, 0, 0, 0}, {2025, 12, 1, 0, 0, 0}).inputs();
}

/// The lines of the golden file for the days of the inputs.
inline std::vector<std::string> golden_lines_of(const std::vector<std::string>& found) {
  std::vector<std::string> lines;
  for (const std::string& line : outlook_golden_lines()) {
    if (line >= found.front().substr(0, 8) && line.substr(0, 8) <= found.back().substr(0, 8)) {
      lines.push_back(line);
    }
  }
  return lines;
}

}  // namespace bess
