// Start-up before the loop: student, process, battery, price level. Writes nothing to the battery.
#pragma once

#include <string>

#include "edge/app/program/edge_clock.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/settings/edge_config.h"
#include "edge/core/base/status.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/level_start.h"
#include "edge/core/control/policy.h"
#include "edge/core/loop/control_settings.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/prices/record/published_prices.h"
#include "edge/records/log/journal.h"
#include "shared/context_classes.h"
#include "shared/price_thresholds.h"

namespace bess {

/// Sets time zone, signals and timers of the process, before any thread starts.
void prepare_process();

/// True if found; else one line on stderr with the remedy.
bool reach_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock);

/// Output of the signature command.
std::string decision_signature_line();

/// True if this machine computes the built-in student like the exporter.
bool check_student();

// Notes of --check and of the start.

/// "month", or quantity and limits of the classes.
std::string context_note(const ContextClasses& context);

/// Source of the starting price level.
struct LevelStartReport {
  LevelStart start{};
  int hours_wanted = 0;
  PublishedHistory history{};  ///< status: what ended or prevented the request
};

std::string level_start_text(const LevelStartReport& level_report);
/// A warning only for an unknown level, which needs days to settle.
JournalLevel journal_level_of(const LevelStartReport& level_report);

/// Operator's orders for --check: lines with line ends, or empty. `now_utc_s` selects reserve and
/// hold.
std::string operator_note(const ControlSettings& control, const Hold& hold, std::int64_t now_utc_s);

/// Comparison of the guard's price thresholds (configuration) with those of the student's proof
/// (weights). Between different thresholds only one of the two acts, or none. Reported at every
/// start, never a refusal.
SettingsNote compare_thresholds(const PriceThresholds& guard, const PriceThresholds& proved);

/// Price level to start with: from the log, or for a student by level from the prices of the last
/// hours. `logged`: of the newest record. `price_server_status`: first price answer.
template <typename World>
LevelStartReport starting_level(const EdgeConfig& config, const PriceLevel& logged,
                                Status price_server_status, World& world) {
  const std::int64_t now_utc_s = utc_seconds(world.clock());
  LevelStartReport level_report{.hours_wanted = config.price.history.hours,
                                .history = {.status = price_server_status}};
  const auto fetch = [&]() -> PriceLevel {
    // A server that has not answered would only delay the start.
    const bool has_answered =
        price_server_status == Status::kOk || price_server_status == Status::kNoRow;
    if (level_report.hours_wanted != 0 && has_answered) {
      level_report.history = world.find_history();
    }
    return level_report.history.level;
  };
  level_report.start = find_start_level(student_context().kind, logged, now_utc_s,
                                        config.price.level_start_centi_eur_per_mwh, fetch);
  return level_report;
}

}  // namespace bess
