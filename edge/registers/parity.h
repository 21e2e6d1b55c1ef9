// Parity of a serial line, as a register map states it and as an operator overrides it.
#pragma once

#include <cstdint>

namespace bess {

enum class Parity : std::uint8_t { kNone, kEven, kOdd };

}  // namespace bess
