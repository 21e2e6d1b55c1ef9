// What happens before the loop: student, process, battery, what earlier runs left, the price level
// to start with, and one line per finding for a person. Nothing here writes to the battery.
#pragma once

#include <string>

#include "edge/app/program/edge_clock.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/settings/edge_config.h"
#include "edge/app/storage/recall.h"
#include "edge/core/base/status.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/level_start.h"
#include "edge/core/control/policy.h"
#include "edge/core/loop/control_settings.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/prices/record/published_prices.h"
#include "edge/records/log/event_log.h"
#include "edge/records/log/journal.h"
#include "shared/context_classes.h"
#include "shared/price_thresholds.h"

namespace bess {

/// Time zone, signals and timers of the process; before any thread is started.
void prepare_process();

/// True when it is found; otherwise one line on stderr says what to mend.
bool reach_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock);

/// Of the sign check's copies: each that was lost or damaged is a line of the journal, and written
/// again.
void report_commission_losses(const EdgeConfig& config);

/// What earlier runs left. Where that cannot be read, a journal line says why, and the battery is
/// not driven until a person clears it.
/// `published_number`: recall.h.
Recall recall_at_start(const EdgeConfig& config, const EventLog& log,
                       std::uint64_t published_number);

/// One journal line: whether the guard enforces what the student is proved for.
void journal_thresholds(const EdgeConfig& config);

/// One journal line where others than the price server could write the prices.
void journal_transport(const EdgeConfig& config);

/// What the signature command prints of this build.
std::string decision_signature_line();

/// True when this machine computes the built-in student as the exporter did.
bool check_student();

// Notes of --check and of the start: the student's context and price level, what the operator asks,
// the thresholds of guard and student.

/// "month", or what the classes are of, with their edges.
std::string context_note(const ContextClasses& context);

/// How the level was come by. What is said of the history counts only if it was asked for.
struct LevelNews {
  LevelStart start{};
  int hours_wanted = 0;
  int hours = 0;  ///< that the rows reach back
  int rows = 0;
  Status status = Status::kOk;  ///< what ended the fetching, or kept it from beginning
};

std::string level_note(const LevelNews& news);
/// Only a level that nothing is known of is worth a warning: it takes days to come right.
JournalLevel journal_level_of(const LevelNews& news);

// What --check says of what the operator asks: each line only where there is one.

/// Lines with their ends; empty when nothing is wanted. `now_utc_s` decides which reserve and hold
/// are in force.
std::string operator_note(const ControlSettings& control, const Hold& hold, std::int64_t now_utc_s);

// The guard's price thresholds beside those that the student is proved for. The one comes from the
// operator's file, the other with the weights; where they differ, a price lies between them for
// which only one of the two answers, or neither. Said at every start, never a reason to refuse it.

struct ThresholdNote {
  bool agree = false;
  std::string
      text;  ///< one line: the thresholds, or each that differs and who answers between the two
};

ThresholdNote compare_thresholds(const PriceThresholds& guard, const PriceThresholds& proved);

// The price level that a controller starts with: kept by the log, or for a student by level filled
// from the prices of the last hours.

/// `logged` is the newest record's, `greeting` what prices have just answered with.
template <typename World>
LevelNews starting_level(const EdgeConfig& config, const PriceLevel& logged, Status greeting,
                         World& world) {
  const std::int64_t now_utc_s = world.clock().now_utc_ns() / kNanosecondsPerSecond;
  LevelNews news{.hours_wanted = config.price.history.hours, .status = greeting};
  const auto fetch = [&]() -> PriceLevel {
    // A server that has just not answered would only hold up the start.
    const bool has_answered = greeting == Status::kOk || greeting == Status::kNoRow;
    if (news.hours_wanted == 0 || !has_answered) return {};
    const PublishedHistory history = world.find_history();
    news.status = history.status;
    news.hours = history.hours;
    news.rows = history.rows;
    return history.level;
  };
  news.start = find_start_level(student_context().kind, logged, now_utc_s,
                                config.price.level_start_centi_eur_per_mwh, fetch);
  return news;
}

}  // namespace bess
