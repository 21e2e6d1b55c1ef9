// A checksum as the end of a text that other programs and people read as well: a comment of TOML
// and of Prometheus, or the last member of a JSON object. Nothing here allocates.
#pragma once

#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

/// What stands before and behind the eight hexadecimal digits. The checksum is of all that stands
/// before.
struct ChecksumFrame {
  std::string_view before;
  std::string_view after;
};
inline constexpr ChecksumFrame kCommentChecksum{"# crc32=", "\n"};
inline constexpr ChecksumFrame kJsonChecksum{",\n  \"crc32\": \"", "\"\n}\n"};

/// What makes a checked text of this one.
FixedText<31> checksum_end(std::string_view text, const ChecksumFrame& frame);

enum class TextState {
  kUnchecked,  ///< of an older program, or its end is cut off
  kIntact,
  kBroken,
};
TextState check_text(std::string_view text, const ChecksumFrame& frame);

/// What the checksum is of; of an unchecked text the whole.
std::string_view without_checksum(std::string_view text, const ChecksumFrame& frame);

}  // namespace bess
