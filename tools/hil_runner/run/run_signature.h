// One number for a run: of every bit of what the battery did, and of what the edge saw and decided.
#pragma once

#include <cstdint>

#include "tools/hil_runner/evidence/evidence.h"

namespace bess {

/// Two runs that differ in it anywhere have two signatures.
std::uint64_t signature_of(const Evidence& evidence);

/// Of every field of the edge's records, and of every byte that it sent with its time. What the
/// battery did follows from these.
std::uint64_t pinned_number_of(const Evidence& evidence);

}  // namespace bess
