#include "edge/records/log/record_codec.h"

#include <algorithm>

#include "edge/records/log/record_fields.h"
#include "shared/crc32.h"

namespace bess {
namespace {

constexpr std::size_t kNumberBytes = 8;
constexpr std::size_t kCrcBytes = 4;
constexpr std::size_t kCrcOffset = kRecordBytes - kCrcBytes;

consteval std::size_t used_bytes() {
  std::size_t bytes = kNumberBytes;
  for (const auto& field : kRecordFields) bytes += field.access.bytes;
  return bytes;
}
static_assert(used_bytes() <= kCrcOffset, "the record on disk is full");

/// CRC of all preceding bytes.
std::uint32_t crc_of(std::span<const std::uint8_t> record) {
  return crc32_of(record.data(), record.size() - kCrcBytes);
}

}  // namespace

void put_bytes(std::uint64_t bits, std::size_t count, std::uint8_t* bytes) {
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<std::uint8_t>(bits >> (8 * i));
}

std::uint64_t take_bytes(std::size_t count, const std::uint8_t* bytes) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < count; ++i) bits |= std::uint64_t{bytes[i]} << (8 * i);
  return bits;
}

void encode_record(const CycleRecord& record, std::uint64_t sequence, RecordBytes& bytes) {
  bytes.fill(0);
  put_bytes(sequence, kNumberBytes, bytes.data());
  std::uint8_t* end = bytes.data() + kNumberBytes;
  for (const auto& field : kRecordFields) {
    put_bytes(static_cast<std::uint64_t>(field.access.read(record)), field.access.bytes, end);
    end += field.access.bytes;
  }
  put_bytes(crc_of(bytes), kCrcBytes, bytes.data() + kCrcOffset);
}

bool is_intact(std::span<const std::uint8_t> stored) {
  return take_bytes(kCrcBytes, stored.data() + stored.size() - kCrcBytes) == crc_of(stored);
}

bool decode_record(std::span<const std::uint8_t> stored, CycleRecord& record,
                   std::uint64_t& sequence) {
  if (!is_intact(stored)) return false;
  const std::size_t crc_offset = stored.size() - kCrcBytes;
  RecordBytes bytes{};  // fields beyond the end of an older record read as zero
  std::copy_n(stored.begin(), crc_offset, bytes.begin());
  record = CycleRecord{};
  sequence = take_bytes(kNumberBytes, bytes.data());
  bool all_known = true;
  const std::uint8_t* begin = bytes.data() + kNumberBytes;
  for (const auto& field : kRecordFields) {
    const auto value = static_cast<std::int64_t>(take_bytes(field.access.bytes, begin));
    all_known = field.access.set(record, value) && all_known;
    begin += field.access.bytes;
  }
  return all_known;
}

}  // namespace bess
