// Files by which others limit the controller: `hold` of an operator, the limit of another program.
// The file through which `bess-edge hold` tells the running controller: one line of fixed length in
// the state folder and in its run_folder, replaced at once. It outlives restarts; when its end has
// passed it means nothing. The younger file is the newer word: a disk that dies may have kept an
// older one.
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

/// Anything but exactly what `format_hold` writes is an unreadable hold.
Hold parse_hold(std::string_view text);

/// What lies at `path`; no file is no hold.
Hold read_hold(const char* path);

/// Where a controller looks for an operator's hold, by this name.
inline constexpr std::string_view kHoldFileName = "hold";

struct HoldReading {
  Hold hold;  ///< unreadable where no file can be understood and one is there
  bool state_is_lost = false;
  bool run_is_lost = false;  ///< the file is there and cannot be understood, another one counts

  friend bool operator==(const HoldReading&, const HoldReading&) = default;
};
/// Of both places the newer word; no file at all is no hold.
HoldReading read_newest_hold(const BothPlaces& paths);

// The file in which another program limits the battery (connection_guard.h has its line): read by
// the control thread every few seconds, so no heap, a fixed buffer, and nothing that could wait: a
// regular file on a memory file system (/run), never a pipe. Who writes it replaces it at once.

class LimitFile {
 public:
  /// `path` must outlive this object.
  explicit LimitFile(const char* path) : path_(path) {}

  /// `is_set` is false where there is no such file. kMalformed: it cannot be understood, or is
  /// there and cannot be read.
  Status read(OutsideLimit& limit, bool& is_set) const;

 private:
  const char* path_;
};

}  // namespace bess
