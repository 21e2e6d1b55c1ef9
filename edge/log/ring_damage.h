// What an opening of the decision log found lost: a card that dies forgets bytes here and there.
#pragma once

#include <cstdint>

#include "edge/log/text_buffer.h"

namespace bess {

struct RingDamage {
  enum class Header { kSound, kFromCopy, kFromRecords };

  Header header = Header::kSound;
  std::int64_t broken_records = 0;   ///< slots that hold neither a record nor nothing
  std::int64_t missing_records = 0;  ///< slots behind the end of the file
  std::int64_t newest_lost = 0;  ///< of both, right behind the newest that is left: perhaps newer
  bool is_set_aside = false;     ///< nothing of the file could be understood
  bool was_absent = false;       ///< no file: not a loss by itself

  [[nodiscard]] bool is_any() const {
    return header != Header::kSound || broken_records > 0 || missing_records > 0 || is_set_aside;
  }
};

/// One line for the journal: what was lost and what was done; only where there is any.
void describe_damage(const RingDamage& damage, const char* path, TextBuffer& line);

}  // namespace bess
