// Notes of --check and of the start: the student's context and price level, what the operator asks,
// the thresholds of guard and student.
#pragma once

#include <string>

#include "edge/base/status.h"
#include "edge/control/hold.h"
#include "edge/control/level_start.h"
#include "edge/log/journal.h"
#include "edge/loop/control_settings.h"
#include "shared/context_classes.h"
#include "shared/price_thresholds.h"

namespace bess {

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

}  // namespace bess
