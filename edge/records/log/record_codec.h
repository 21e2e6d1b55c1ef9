// One CycleRecord as 512 bytes on disk, the same on every machine:
//   0    sequence number, u64        8 ...  the fields in the order of record_fields.h
//   ...  zeros for later fields      508    CRC-32 of everything before it
// All integers are little-endian and of fixed width. A field may be added behind the last one
// without a new version: older records read as zero there, also those of 256 bytes that
// earlier programs wrote.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "edge/core/control/control_types.h"

namespace bess {

/// One record to a disk sector of 512 bytes, so that a torn sector never costs more than one.
inline constexpr std::size_t kRecordBytes = 512;
inline constexpr std::size_t kOlderRecordBytes = 256;
using RecordBytes = std::array<std::uint8_t, kRecordBytes>;

void encode_record(const CycleRecord& record, std::uint64_t sequence, RecordBytes& bytes);

/// Whether the bytes are what was once written, whatever it means; not so where nothing ever was.
bool is_intact(std::span<const std::uint8_t> stored);

/// False when the bytes are not a whole record: torn, never written, or of a later program.
/// `stored`: kRecordBytes, or kOlderRecordBytes.
bool decode_record(std::span<const std::uint8_t> stored, CycleRecord& record,
                   std::uint64_t& sequence);

}  // namespace bess
