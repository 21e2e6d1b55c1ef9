#include "edge/log/text_checksum.h"

#include <cstdio>

#include "shared/crc32.h"

namespace bess {
namespace {

constexpr std::size_t kDigits = 8;

/// The end that a checked text of this frame has; shorter than that: the whole.
std::string_view end_of(std::string_view text, const ChecksumFrame& frame) {
  const std::size_t size = frame.before.size() + kDigits + frame.after.size();
  return text.size() < size ? text : text.substr(text.size() - size);
}

}  // namespace

FixedText<31> checksum_end(std::string_view text, const ChecksumFrame& frame) {
  Crc32 crc;
  crc.add_bytes(text.data(), text.size());
  char end[32];
  std::snprintf(end, sizeof end, "%.*s%08x%.*s", static_cast<int>(frame.before.size()),
                frame.before.data(), crc.value(), static_cast<int>(frame.after.size()),
                frame.after.data());
  return {end};
}

TextState check_text(std::string_view text, const ChecksumFrame& frame) {
  const std::string_view end = end_of(text, frame);
  if (!end.starts_with(frame.before) || !end.ends_with(frame.after)) return TextState::kUnchecked;
  const std::string_view body = text.substr(0, text.size() - end.size());
  return checksum_end(body, frame).view() == end ? TextState::kIntact : TextState::kBroken;
}

std::string_view without_checksum(std::string_view text, const ChecksumFrame& frame) {
  if (check_text(text, frame) == TextState::kUnchecked) return text;
  return text.substr(0, text.size() - end_of(text, frame).size());
}

}  // namespace bess
