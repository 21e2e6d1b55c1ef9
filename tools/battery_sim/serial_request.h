// Requests of a serial line: whole frames, whichever unit they are for. libmodbus reads those of
// one unit alone, and takes what follows a request to another for that one's reply.
#pragma once

#include <cstdint>

#include "tools/battery_sim/bus_reply.h"

namespace bess {

enum class SerialRead : std::uint8_t {
  kRequest,
  kNoise,  ///< not whole in time, or its CRC is wrong: what was on the line is thrown away
  kGone,   ///< the line itself
};

/// Waits `byte_timeout_ms` for each next byte of a frame. Calls for function 3, 4, 6 and 16 are
/// known by their length, others end with such a silence.
SerialRead read_serial_request(int fd, int byte_timeout_ms, BusRequest& request);

}  // namespace bess
