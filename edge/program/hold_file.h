// The file through which `bess-edge hold` tells the running controller: one line of fixed length in the
// state folder, replaced at once. It outlives restarts; when its end has passed it means nothing.
//   bess-hold 1 power_w=+000002000 until=2026-11-22T14:00:00Z crc32=0123abcd
// Nothing here allocates.
#pragma once

#include <cstddef>
#include <string_view>

#include "edge/control/hold.h"
#include "shared/fixed_text.h"

namespace bess {

inline constexpr std::size_t kHoldFileBytes = 73;  ///< with its line end
using HoldText = FixedText<kHoldFileBytes>;

HoldText format_hold(const Hold& hold);

/// Anything but exactly what `format_hold` writes is an unreadable hold.
Hold parse_hold(std::string_view text);

/// What lies at `path`; no file is no hold.
Hold read_hold(const char* path);

}  // namespace bess
