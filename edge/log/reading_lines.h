// What the journal says of a reading that is missing or beyond its range: a line when it begins and
// when it is over. Written by the log thread; nothing allocates.
#pragma once

#include "edge/control/control_types.h"
#include "edge/log/run_status.h"
#include "edge/log/text_buffer.h"

namespace bess {

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
