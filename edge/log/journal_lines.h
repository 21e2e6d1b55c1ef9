// Lines of the journal on holds, on a meter and on readings of the battery, one for each change.
// Written by the log thread; nothing allocates.
#pragma once

#include "edge/control/control_types.h"
#include "edge/log/run_status.h"
#include "edge/log/text_buffer.h"

namespace bess {

// An operator's hold: a line when it begins, when it changes, when it is over, and once when its
// file cannot be read.
class HoldLines {
 public:
  /// Appends the line that this cycle is worth; false when it is worth none.
  bool add_line(const CycleRecord& record, bool is_in_control, TextBuffer& line);

 private:
  HoldReport before_{};
};

// A meter that is not to be believed: a line when it is found, and when it agrees again; the same
// of a house load that cannot be.
class MeterLines {
 public:
  /// Appends the line that this cycle is worth; false when it is worth none.
  bool add_trust_line(const CycleRecord& record, TextBuffer& line);
  bool add_house_line(const CycleRecord& record, TextBuffer& line);

 private:
  bool was_mismatch_ = false;
  bool was_implausible_ = false;
};

// A reading that is missing or beyond its range: a line when it begins and when it is over.
class ReadingLines {
 public:
  /// Appends the line that this cycle is worth; false when it is worth none.
  bool add_lost_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);
  bool add_cut_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);

 private:
  std::int16_t lost_ = 0;
  std::int16_t cut_ = 0;
};

}  // namespace bess
