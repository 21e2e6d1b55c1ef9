// What the journal says of a meter that is not to be believed: a line when it is found, and when
// it agrees again; the same of a house load that cannot be. Written by the log thread; nothing
// allocates.
#pragma once

#include "edge/control/control_types.h"
#include "edge/log/text_buffer.h"

namespace bess {

class MeterLines {
 public:
  /// Appends the line that this cycle is worth; false when it is worth none.
  bool add_trust_line(const CycleRecord& record, TextBuffer& line);
  bool add_house_line(const CycleRecord& record, TextBuffer& line);

 private:
  bool was_mismatch_ = false;
  bool was_implausible_ = false;
};

}  // namespace bess
