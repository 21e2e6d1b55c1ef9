// What the journal says of an operator's hold: a line when it begins, when it changes, when it is
// over, and once when its file cannot be read. Written by the log thread; nothing allocates.
#pragma once

#include "edge/control/control_types.h"
#include "edge/log/text_buffer.h"

namespace bess {

class HoldLines {
 public:
  /// Appends the line that this cycle is worth; false when it is worth none.
  bool add_line(const CycleRecord& record, bool is_in_control, TextBuffer& line);

 private:
  HoldReport before_{};
};

}  // namespace bess
