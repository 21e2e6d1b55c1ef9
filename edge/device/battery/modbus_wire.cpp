#include "edge/device/battery/modbus_wire.h"

#include <modbus/modbus.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>

#include "edge/core/base/check.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

// Ends an idle connection within a minute if its peer lost power or address.
constexpr int kKeepAliveIdleS = 30;
constexpr int kKeepAliveIntervalS = 10;
constexpr int kKeepAliveProbes = 3;
constexpr int kUserTimeoutMs = 30'000;

char parity_letter(Parity parity) {
  return parity == Parity::kEven ? 'E' : parity == Parity::kOdd ? 'O' : 'N';
}

void set_option(int fd, int level, int option, int value) {
  // Best effort: without them the next request's time-out detects a dead connection.
  static_cast<void>(setsockopt(fd, level, option, &value, sizeof value));
}

void watch_connection(int fd) {
  set_option(fd, SOL_SOCKET, SO_KEEPALIVE, 1);
  set_option(fd, IPPROTO_TCP, TCP_KEEPIDLE, kKeepAliveIdleS);
  set_option(fd, IPPROTO_TCP, TCP_KEEPINTVL, kKeepAliveIntervalS);
  set_option(fd, IPPROTO_TCP, TCP_KEEPCNT, kKeepAliveProbes);
  set_option(fd, IPPROTO_TCP, TCP_USER_TIMEOUT, kUserTimeoutMs);
}

/// libmodbus connects with select(), which overflows its set for descriptors from 1024.
bool next_descriptor_fits_select() {
  constexpr int kOthersMeanwhile = 32;  ///< the price thread may open some in between
  const int probe = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
  if (probe < 0) return false;
  ::close(probe);
  return probe < FD_SETSIZE - kOthersMeanwhile;
}

Status status_of_connect_errno(int error) {
  // libmodbus 3.1.6 leaves EINPROGRESS when connecting times out.
  return error == ETIMEDOUT || error == EINPROGRESS ? Status::kTimeout : Status::kNotConnected;
}

}  // namespace

ModbusWire::ModbusWire(const BatteryLinkSettings& settings, std::int32_t connect_timeout_ms)
    : rtu_(settings.rtu),
      context_(rtu_ ? modbus_new_rtu(settings.device.c_str(), settings.baud,
                                     parity_letter(settings.parity), 8, settings.stop_bits)
                    : modbus_new_tcp(settings.host.c_str(), settings.port)) {
  BESS_CHECK(context_ != nullptr);
  modbus_set_response_timeout(context_, static_cast<std::uint32_t>(connect_timeout_ms / 1'000),
                              static_cast<std::uint32_t>(connect_timeout_ms % 1'000 * 1'000));
}

ModbusWire::~ModbusWire() {
  close();
  modbus_free(context_);
}

Status ModbusWire::open() {
  if (!rtu_ && !next_descriptor_fits_select()) return Status::kNotConnected;
  if (modbus_connect(context_) != 0) {
    const Status status = status_of_connect_errno(errno);
    modbus_close(context_);  // a failed connect may leave a socket open
    return status;
  }
  fd_ = modbus_get_socket(context_);
  if (rtu_) {
    discard_input();
  } else {
    watch_connection(fd_);
  }
  return Status::kOk;
}

void ModbusWire::close() {
  if (fd_ < 0) return;
  if (rtu_) discard_input();  // else closing waits for bytes that an unplugged adapter never takes
  modbus_close(context_);
  fd_ = -1;
}

bool ModbusWire::is_lost() const {
  while (true) {
    pollfd event{.fd = fd_, .events = POLLIN, .revents = 0};
    if (poll(&event, 1, 0) == 0) return false;
    if ((event.revents & (POLLERR | POLLHUP | POLLNVAL)) != 0) return true;
    if (rtu_) return false;
    std::uint8_t unasked[kFrameBytesMax];
    if (recv(fd_, unasked, sizeof unasked, MSG_DONTWAIT) <= 0) return true;
  }
}

void ModbusWire::discard_input() { static_cast<void>(modbus_flush(context_)); }

Status ModbusWire::send(const ModbusFrame& frame) {
  const auto size = static_cast<std::size_t>(frame.size);
  const ssize_t sent = rtu_ ? write(fd_, frame.bytes, size)
                            : ::send(fd_, frame.bytes, size, MSG_NOSIGNAL | MSG_DONTWAIT);
  return sent == frame.size ? Status::kOk : Status::kNotConnected;
}

Status ModbusWire::receive(int count, std::int64_t deadline_monotonic_ns, ModbusFrame& frame) {
  BESS_CHECK(count > 0 && frame.size + count <= kFrameBytesMax);
  while (true) {
    const std::int64_t left_ns = deadline_monotonic_ns - clock_ns(CLOCK_MONOTONIC);
    if (left_ns <= 0) return Status::kTimeout;
    const timespec left{.tv_sec = static_cast<time_t>(left_ns / kNanosecondsPerSecond),
                        .tv_nsec = static_cast<long>(left_ns % kNanosecondsPerSecond)};
    pollfd event{.fd = fd_, .events = POLLIN, .revents = 0};
    const int ready = ppoll(&event, 1, &left, nullptr);
    if (ready == 0 || (ready < 0 && errno == EINTR)) continue;  // the deadline decides
    if (ready < 0) return Status::kNotConnected;
    const ssize_t got = read(fd_, frame.bytes + frame.size, static_cast<std::size_t>(count));
    if (got < 0 && (errno == EINTR || errno == EAGAIN)) continue;
    if (got <= 0) return Status::kNotConnected;  // closed, reset, or the adapter was unplugged
    frame.size += static_cast<int>(got);
    return Status::kOk;
  }
}

}  // namespace bess
