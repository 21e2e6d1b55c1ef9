// Codec of a CycleRecord, 512 bytes on disk, the same on every machine:
//   0    sequence number, u64        8 ...  the fields in the order of record_fields.h
//   ...  zeros for later fields      508    CRC-32 of everything before it
// All integers are little-endian and of fixed width. A field may be added at the end without a new
// version: older records, also those of 256 bytes, read as zero there.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "edge/core/control/control_types.h"

namespace bess {

/// One record per disk sector of 512 bytes, so that a torn sector loses one record.
inline constexpr std::size_t kRecordBytes = 512;
inline constexpr std::size_t kOlderRecordBytes = 256;
using RecordBytes = std::array<std::uint8_t, kRecordBytes>;

/// A little-endian integer of `count` bytes.
void put_bytes(std::uint64_t bits, std::size_t count, std::uint8_t* bytes);
std::uint64_t take_bytes(std::size_t count, const std::uint8_t* bytes);

void encode_record(const CycleRecord& record, std::uint64_t sequence, RecordBytes& bytes);

/// Whether the CRC is correct; false for a slot that was never written.
bool is_intact(std::span<const std::uint8_t> stored);

/// False when the bytes are no intact record: torn, never written, or of a later version.
/// `stored`: kRecordBytes, or kOlderRecordBytes.
bool decode_record(std::span<const std::uint8_t> stored, CycleRecord& record,
                   std::uint64_t& sequence);

}  // namespace bess
