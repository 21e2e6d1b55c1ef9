// Why a cycle ordered what it did, with everything that a person asks next: who decided, since when
// and until when, on which inputs, and at which prices and states of charge it would have been
// another order. Made from the decision log and the settings, beside the controller.
#pragma once

#include <charconv>
#include <cstdint>
#include <string>
#include <string_view>

#include "edge/core/control/control_types.h"
#include "edge/core/loop/control_settings.h"
#include "edge/records/log/log_reader.h"
#include "edge/records/why/margins.h"
#include "shared/host/json.h"
#include "shared/units_and_limits.h"

namespace bess {

// How long something holds, as a person writes it: 90s, 15m, 2h, 1d12h.

/// Seconds of whole numbers, each with s, m, h or d behind it; false when it is none, 0, or more
/// than a week.
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
  std::int64_t since_utc_s = 0;  ///< tick from which on this reason has held, in one run of it
  int cycles = 1;                ///< that it has held for, this one included
  /// Price, measurement and student were there. Without them nothing below is said.
  bool has_margins = false;
  Margins margins{};
  /// This program's student decides otherwise than the log says: another version wrote it.
  bool is_other_student = false;
};

/// Of record `number` of the log; false when it cannot be read any more.
bool explain(const LogReader& log, std::uint64_t number, const PriceThresholds& thresholds,
             Explanation& explanation);

/// Of the student on what a cycle saw; false where it was not asked.
bool margins_of(const CycleRecord& record, const PriceThresholds& thresholds, Margins& margins);

/// The record whose order was in force at that instant, the newest where the clock was stepped; 0 =
/// none.
std::uint64_t number_at(const LogReader& log, std::int64_t utc_s);

/// What ends the reason, and when: "until the SoC is above 10.5 %". Empty for the student's own
/// decision.
std::string what_ends(const CycleRecord& record, const ControlSettings& settings);

/// "charges up to 83.49, rests from 83.50 to 211.49, discharges from 211.50"
std::string price_margins_text(const Margins& at);
Json margins_json(const Margins& at);

/// Some lines, each ended, in local time.
std::string explanation_text(const Explanation& explanation, const ControlSettings& settings);
Json explanation_json(const Explanation& explanation, const ControlSettings& settings);

}  // namespace bess
