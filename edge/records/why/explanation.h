// Explanation of a control cycle: decider, start, end, inputs, margins. Made from decision log and
// settings, outside the controller.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "edge/core/control/control_types.h"
#include "edge/core/loop/control_settings.h"
#include "edge/records/log/log_reader.h"
#include "edge/records/why/margins.h"
#include "shared/host/json.h"
#include "shared/units_and_limits.h"

namespace bess {

/// Parses a duration such as 90s, 15m, 2h or 1d12h. False if malformed, 0, or more than a week.
inline bool parse_duration(std::string_view text, std::int64_t& seconds) {
  constexpr std::int64_t kWeekS = 7 * kSecondsPerDay;
  constexpr std::string_view kUnits = "smhd";
  constexpr std::int64_t kUnitSeconds[] = {1, 60, 3'600, kSecondsPerDay};
  seconds = 0;
  while (!text.empty()) {
    std::int32_t count = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), count);
    if (error != std::errc{} || count < 0 || end == text.data() + text.size()) return false;
    const std::size_t unit = kUnits.find(*end);
    if (unit == kUnits.npos) return false;
    seconds += count * kUnitSeconds[unit];
    if (seconds > kWeekS) return false;
    text.remove_prefix(static_cast<std::size_t>(end + 1 - text.data()));
  }
  return seconds > 0;
}

struct Explanation {
  CycleRecord record{};
  std::int64_t since_utc_s = 0;  ///< first tick of the uninterrupted reason
  int cycles = 1;                ///< control cycles since then, this one included
  /// Price, measurement and student action are known; else there are no margins.
  bool has_margins = false;
  Margins margins{};
  /// The student of this program decides differently: another version wrote the log.
  bool is_other_student = false;
  std::vector<CycleRecord> evidence{};  ///< readings up to that of the trip; empty without a trip
};

/// Explains record `number` of the log; false if it is no longer readable.
bool explain(const LogReader& log, std::uint64_t number, const PriceThresholds& thresholds,
             Explanation& explanation);

/// Margins of the student for the inputs of a control cycle; false without a student decision.
bool margins_of(const CycleRecord& record, const PriceThresholds& thresholds, Margins& margins);

/// Record whose order was in force at that time, the newest if the clock was stepped; 0 = none.
std::uint64_t number_at(const LogReader& log, std::int64_t utc_s);

/// End condition of the reason: "until the SoC is above 10.5 %". Empty for the student.
std::string what_ends(const CycleRecord& record, const ControlSettings& settings);

/// "charges up to 83.49, idle from 83.50 to 211.49, discharges from 211.50"
std::string price_margins_text(const Margins& at);
Json margins_json(const Margins& at);

/// Lines with line ends, in local time.
std::string explanation_text(const Explanation& explanation, const ControlSettings& settings);
Json explanation_json(const Explanation& explanation, const ControlSettings& settings);

}  // namespace bess
