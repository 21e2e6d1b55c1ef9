// One CycleRecord as 256 bytes on disk, the same on every machine:
//   0    sequence number, u64        8 ...  the fields in the order of record_fields.h
//   ...  zeros for later fields      252    CRC-32 of everything before it
// All integers are little-endian and of fixed width. A field may be added behind the last one
// without a new version: older records read as zero there.
#pragma once

#include <array>
#include <cstdint>

#include "edge/control/control_types.h"

namespace bess {

/// Two records to a disk sector of 512 bytes, so that a torn sector never costs more than two.
inline constexpr std::size_t kRecordBytes = 256;
using RecordBytes = std::array<std::uint8_t, kRecordBytes>;

void encode_record(const CycleRecord& record, std::uint64_t sequence, RecordBytes& bytes);

/// False when the bytes are not a whole record: torn, never written, or of a later program.
bool decode_record(const RecordBytes& bytes, CycleRecord& record, std::uint64_t& sequence);

}  // namespace bess
