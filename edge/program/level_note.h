// What a person is told of the student's context: what it is, and how its price level was come by
// at the start.
#pragma once

#include <string>

#include "edge/base/status.h"
#include "edge/control/level_start.h"
#include "edge/log/journal.h"
#include "shared/context_classes.h"

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

}  // namespace bess
