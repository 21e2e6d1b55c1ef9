// Common readers of scenario tables: numbers with a range, time spans, lists of pairs.
#pragma once

#include <fmt/core.h>

#include <optional>
#include <string>
#include <string_view>

#include "shared/host/toml_document.h"
#include "shared/host/toml_reader.h"
#include "shared/units_and_limits.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

inline constexpr double kScenarioMinutesMax = 60.0 * 24 * 400;

inline void read_decimal(TomlTable& table, std::string_view key, double& value, double min,
                         double max) {
  const TomlValue* const node = table.node(key);
  if (node == nullptr) return;
  const auto number = node->number();
  if (!number || !(*number >= min && *number <= max)) {
    return table.fail(key, fmt::format("must be a number from {:g} to {:g}", min, max));
  }
  value = *number;
}

/// Error for a time after the end, which would never be reached.
inline std::string after_the_end(double scenario_minutes) {
  return fmt::format("is after the end at {:g} minutes", scenario_minutes);
}

inline void read_span(TomlTable& table, double scenario_minutes, MinuteSpan& span) {
  read_decimal(table, "from_min", span.from_min, 0, kScenarioMinutesMax);
  read_decimal(table, "to_min", span.to_min, 0, kScenarioMinutesMax);
  if (!table.ok()) return;
  if (span.to_min <= span.from_min) table.fail("to_min", "must be later than from_min");
  const bool is_over = table.has("to_min") && span.to_min > scenario_minutes;
  if (span.from_min >= scenario_minutes || is_over) {
    table.fail(is_over ? "to_min" : "from_min", after_the_end(scenario_minutes));
  }
}

inline void read_text(TomlTable& table, std::string_view key, std::string& value) {
  if (const std::string* const text = table.text(key)) value = *text;
}

/// Calls `take(first, second)` for each pair of a list; it returns an error or "".
template <typename Take>
void read_pairs(TomlTable& table, std::string_view key, const Take& take) {
  const TomlArray* const list = table.array(key);
  if (list == nullptr) return;
  for (const TomlValue& item : *list) {
    const auto* const pair = item.as<TomlArray>();
    const auto first = pair != nullptr && pair->size() == 2 ? (*pair)[0].number() : std::nullopt;
    const auto second = first ? (*pair)[1].number() : std::nullopt;
    if (!second) {
      return table.fail_at(item, std::string(key) + " must be a list of pairs of numbers");
    }
    if (const std::string wrong = take(*first, *second); !wrong.empty()) {
      return table.fail_at(item, fmt::format("{} {} {}", table.where(), key, wrong));
    }
  }
}

/// Steps, each until the next: ascending in time, before the end.
inline void read_steps(TomlTable& table, double scenario_minutes,
                       std::vector<ScenarioStep>& steps) {
  read_pairs(table, "steps", [&](double from_min, double value) -> std::string {
    if (!steps.empty() && from_min <= steps.back().from_min) return "must be ascending in time";
    if (from_min >= scenario_minutes) return after_the_end(scenario_minutes);
    steps.push_back({from_min, value});
    return "";
  });
}

/// The same in seconds, for faults.
template <typename Fault>
void read_fault_span(TomlTable& table, double scenario_minutes, Fault& fault) {
  MinuteSpan span;
  read_span(table, scenario_minutes, span);
  fault.from_s = 60 * span.from_min;
  fault.to_s = 60 * span.to_min;
}

/// Span and on-off times of faults; every opportunity within them counts.
inline void read_fault_times(TomlTable& table, double scenario_minutes, FaultSchedule& schedule) {
  schedule.every = 1;
  read_fault_span(table, scenario_minutes, schedule);
  read_decimal(table, "on_s", schedule.on_s, 1, kSecondsPerDay);
  read_decimal(table, "off_s", schedule.off_s, 1, kSecondsPerDay);
  if (table.ok() && (schedule.on_s > 0) != (schedule.off_s > 0)) {
    table.fail(schedule.on_s > 0 ? "on_s" : "off_s", "requires the other of on_s and off_s");
  }
}

/// Required key `kinds`: faults of bess-sim battery. `refuse(info)` returns an error or "".
template <typename Refuse>
void read_fault_kinds(TomlTable& table, std::vector<BatteryFault>& faults, const Refuse& refuse) {
  table.require("kinds");
  const TomlArray* const kinds = table.array("kinds");
  for (std::size_t i = 0; kinds != nullptr && i < kinds->size(); ++i) {
    const TomlValue& item = (*kinds)[i];
    const auto* const name = item.as<std::string>();
    const BatteryFaultInfo* const found = name == nullptr ? nullptr : find_fault(*name);
    if (found == nullptr) {
      table.fail_at(item, "unknown fault of the battery (see bess-sim battery --help)");
    } else if (const std::string why = refuse(*found); !why.empty()) {
      table.fail_at(item, why);
    } else {
      faults.push_back(found->fault);
    }
  }
}

}  // namespace bess
