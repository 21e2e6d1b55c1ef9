#include "tools/battery_sim/serial_request.h"

#include <poll.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>

namespace bess {
namespace {

constexpr int kBytesMax = 256;  ///< unit, PDU of 253, CRC
constexpr int kBytesMin = 4;

/// How many more bytes the frame has; its seventh tells at the latest.
int missing_bytes(const BusRequest& request) {
  if (request.size < 7) return 7 - request.size;
  switch (request.function()) {
    case 3:
    case 4:
    case 6:
      return 8 - request.size;
    case 16:
      return std::min(9 + request.bytes[6], kBytesMax) - request.size;
    default:
      return kBytesMax - request.size;
  }
}

/// Over a whole frame, its CRC included, it is 0. Not the edge's own: two ends that share it share
/// its mistakes.
std::uint16_t crc_of(const BusRequest& request) {
  std::uint16_t crc = 0xFFFF;
  for (int i = 0; i < request.size; ++i) {
    crc = static_cast<std::uint16_t>(crc ^ request.bytes[i]);
    for (int bit = 0; bit < 8; ++bit) {
      crc = static_cast<std::uint16_t>((crc & 1) != 0 ? crc >> 1 ^ 0xA001 : crc >> 1);
    }
  }
  return crc;
}

}  // namespace

SerialRead read_serial_request(int fd, int byte_timeout_ms, BusRequest& request) {
  request.header = 0;
  request.size = 0;
  pollfd line{.fd = fd, .events = POLLIN, .revents = 0};
  for (int missing = missing_bytes(request); missing > 0; missing = missing_bytes(request)) {
    if (poll(&line, 1, byte_timeout_ms) <= 0) break;
    const ssize_t got = read(fd, request.bytes + request.size, static_cast<std::size_t>(missing));
    if (got == 0 || (got < 0 && (errno == EIO || errno == EBADF))) return SerialRead::kGone;
    if (got > 0) request.size += static_cast<int>(got);
  }
  if (request.size >= kBytesMin && crc_of(request) == 0) return SerialRead::kRequest;
  tcflush(fd, TCIFLUSH);
  return SerialRead::kNoise;
}

}  // namespace bess
