// Operator files: hold of an operator, limit of another program. The hold file of `bess-edge hold`
// is one line of fixed length in the state folder and in run_folder, replaced atomically. It
// survives restarts and has no effect after its end time. The newer of both files is used, because
// a failed disk may have an older one.
//   bess-hold 1 power_w=+000002000 until=2026-11-22T14:00:00Z crc32=0123abcd
// Nothing here allocates.
#pragma once

#include <cstddef>
#include <string_view>

#include "edge/app/settings/edge_config.h"
#include "edge/core/control/hold.h"
#include "edge/core/site/connection_guard.h"
#include "shared/fixed_text.h"

namespace bess {

inline constexpr std::size_t kHoldFileBytes = 73;  ///< with its line end
using HoldText = FixedText<kHoldFileBytes>;

HoldText format_hold(const Hold& hold);

/// Any text that `format_hold` does not write is an unreadable hold.
Hold parse_hold(std::string_view text);

/// Reads the hold at `path`; no file is no hold.
Hold read_hold(const char* path);

/// File name of the hold in state and run folder.
inline constexpr std::string_view kHoldFileName = "hold";

struct HoldReading {
  Hold hold;  ///< unreadable if files exist and none is readable
  bool state_is_lost = false;
  bool run_is_lost = false;  ///< this file is unreadable and the other one is used

  friend bool operator==(const HoldReading&, const HoldReading&) = default;
};
/// Newer hold of both places; no file is no hold.
HoldReading read_newest_hold(const StateFilePaths& paths);

// Limit file of another program (format: connection_guard.h), read by the control thread every few
// seconds: no heap, fixed buffer, and no blocking, so a regular file in memory (/run), never a
// pipe. Writers replace it atomically.

struct LimitFile {
  const char* path;  ///< must outlive this object

  /// `is_set` is false without a file. kMalformed: unreadable or malformed.
  Status read(OutsideLimit& limit, bool& is_set) const;
};

}  // namespace bess
