#include "tools/simulators/battery_sim/battery_server.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdio>
#include <cstring>

#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr std::int32_t kIllegalFunction = 1;

/// False for a function that recordings do not have.
bool read_request(const BusRequest& request, BusExchange& exchange) {
  exchange.unit = request.unit();
  exchange.function = static_cast<std::uint8_t>(request.function());
  exchange.address = static_cast<std::uint16_t>(request.address());
  const bool is_read = exchange.function == 3 || exchange.function == 4;
  if (!is_read && !exchange.is_write()) return false;
  const int count = is_read ? request.word(4) : request.write_count();
  if (count < 1 || count > BusExchange::kRegistersMax) return false;
  exchange.count = static_cast<std::uint16_t>(count);
  if (is_read) return true;
  const int first = exchange.function == 6 ? 4 : 7;  // behind address, or count and bytes
  for (int i = 0; i < count; ++i) {
    exchange.registers[static_cast<std::size_t>(i)] =
        static_cast<std::uint16_t>(request.word(first + 2 * i));
  }
  return true;
}

void add_word(Bytes& bytes, int word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8));
  bytes.push_back(static_cast<std::uint8_t>(word));
}

/// Unit and PDU of a good reply.
Bytes content_of(const BusExchange& answer) {
  Bytes bytes = {static_cast<std::uint8_t>(answer.unit), answer.function};
  if (answer.is_write()) {
    add_word(bytes, answer.address);
    add_word(bytes, answer.function == 6 ? answer.registers[0] : answer.count);
    return bytes;
  }
  bytes.push_back(static_cast<std::uint8_t>(2 * answer.count));
  for (int i = 0; i < answer.count; ++i) {
    add_word(bytes, answer.registers[static_cast<std::size_t>(i)]);
  }
  return bytes;
}

constexpr int kBytesMax = 256;  ///< unit, PDU of 253, CRC
constexpr int kBytesMin = 4;
constexpr int kByteTimeoutMs = 500;  ///< within a frame on a serial line, as in libmodbus

/// Missing bytes of the frame; known after seven bytes at most.
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

/// 0 over a complete frame with its CRC. Independent of the edge's implementation, so that errors
/// do not cancel.
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

BatteryServer::BatteryServer(const BatteryServerSettings& settings, const RegisterMap& map,
                             SimulatedBattery& battery, const ScaledClock& clock,
                             MeteredHouse* house)
    : settings_(settings), rtu_(!settings.serial_device.empty()), map_(map), clock_(clock) {
  context_.reset(rtu_ ? modbus_new_rtu(settings.serial_device.c_str(), settings.baud,
                                       settings.parity, 8, settings.stop_bits)
                      : modbus_new_tcp(settings.host.c_str(), settings.port));
  if (context_ == nullptr) fail("no memory for libmodbus");
  device_.emplace(map, battery, context_.get(), std::vector{settings.faults}, rtu_,
                  clock.start_utc_ns(), house);
  if (rtu_) {
    open_serial();
  } else {
    listen_tcp();
  }
}

BatteryServer::~BatteryServer() {
  for (const Client& client : clients_) close(client.fd);
  if (listen_fd_ >= 0) close(listen_fd_);
}

void BatteryServer::listen_tcp() {
  listen_fd_ = modbus_tcp_listen(context_.get(), 4);
  if (listen_fd_ < 0) {
    const int error = errno;
    fail("cannot listen on {}:{}: {}", settings_.host, settings_.port,
         error == EADDRINUSE ? "the port is in use; choose another with --port"
                             : std::strerror(error));
  }
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(listen_fd_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
}

void BatteryServer::open_serial() {
  modbus_set_slave(context_.get(), map_.unit);  // required by libmodbus; all units are served
  if (modbus_connect(context_.get()) != 0) {
    fail("{}: cannot open the serial line: {}", settings_.serial_device, std::strerror(errno));
  }
  clients_.push_back({.fd = modbus_get_socket(context_.get())});
}

void BatteryServer::run(int stop_fd) {
  stop_fd_ = stop_fd;
  while (true) {
    std::vector<pollfd> events = {{.fd = stop_fd, .events = POLLIN, .revents = 0},
                                  {.fd = listen_fd_, .events = POLLIN, .revents = 0}};
    for (const Client& c : clients_) events.push_back({.fd = c.fd, .events = POLLIN, .revents = 0});
    if (poll(events.data(), events.size(), -1) < 0 && errno != EINTR) return;
    if (events[0].revents != 0) break;
    // Clients first: a reconnecting master must not be refused as a second client.
    for (std::size_t i = 0; i + 2 < events.size(); ++i) {
      if (events[i + 2].revents != 0) serve(clients_[i]);
    }
    std::erase_if(clients_, [](const Client& client) { return client.fd < 0; });
    if (events[1].revents != 0) accept_client();
  }
  device_->advance(clock_.now_utc_ns());
}

void BatteryServer::accept_client() {
  Client client{.fd = accept4(listen_fd_, nullptr, nullptr, SOCK_CLOEXEC)};
  if (client.fd < 0) return;
  const bool full = static_cast<int>(clients_.size()) >= settings_.clients_max;
  const BatteryFault fault = device_->on_connect(clock_.now_utc_ns());
  if (full || fault == BatteryFault::kRefuse) return close_client(client, false);
  clients_.push_back(client);
}

void BatteryServer::close_client(Client& client, bool reset) {
  const linger at_once{.l_onoff = 1, .l_linger = 0};  // closing then sends RST
  if (reset) setsockopt(client.fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(client.fd);
  client.fd = -1;
}

/// False: no request to answer.
bool BatteryServer::receive(Client& client, BusRequest& request) {
  if (rtu_) {
    const SerialRead read = read_serial_request(client.fd, kByteTimeoutMs, request);
    if (read == SerialRead::kGone)
      fail("{}: the serial line has disappeared", settings_.serial_device);
    return read == SerialRead::kRequest;
  }
  request.header = kTcpHeaderBytes;
  modbus_set_socket(context_.get(), client.fd);
  request.size = modbus_receive(context_.get(), request.bytes);
  if (request.size < 0) close_client(client, false);
  return request.size > 0;
}

void BatteryServer::serve(Client& client) {
  BusRequest request{};
  if (!receive(client, request)) return;
  // Other unit or half-open connection: no answer, as on a bus.
  const bool is_here = recorded_ != nullptr ? recorded_->has_unit(request.unit())
                                            : device_->serves_unit(request.unit());
  if (!is_here || client.half_open) return;
  if (recorded_ != nullptr) return answer_as_recorded(client, request);
  if (!wait(settings_.response_delay_ms)) return;
  answer_with_fault(client, request, device_->on_request(request, clock_.now_utc_ns()));
}

/// Recorded result. Prints one line if the recording has none.
BusExchange BatteryServer::recorded_answer(const BusRequest& request) {
  BusExchange exchange;
  const std::int64_t now_ns = clock_.now_utc_ns();
  if (!shift_ns_) shift_ns_ = clock_.is_real_time() ? recorded_->first_utc_ns() - now_ns : 0;
  exchange.utc_ns = now_ns + *shift_ns_;
  if (!read_request(request, exchange)) {
    exchange.outcome = BusOutcome::kException;
    exchange.exception = kIllegalFunction;
    return exchange;
  }
  const std::string reported = recorded_->answer(exchange);
  if (!reported.empty()) {
    std::printf("%s %s\n", utc_text(exchange.utc_ns / kNanosecondsPerSecond).c_str(),
                reported.c_str());
    std::fflush(stdout);
  }
  return exchange;
}

void BatteryServer::answer_as_recorded(Client& client, const BusRequest& request) {
  constexpr std::int64_t kLatencyMsMax = 60'000;
  const BusExchange recorded = recorded_answer(request);
  // Wall time: a recording replayed faster has shorter latencies.
  const std::int64_t simulated_us = recorded.latency_us * recorded_->head().time_scale;
  const std::int64_t latency_ms = std::min(simulated_us / clock_.scale / 1'000, kLatencyMsMax);
  if (!wait(static_cast<std::int32_t>(latency_ms))) return;
  switch (recorded.outcome) {
    case BusOutcome::kTimeout:
      return;
    case BusOutcome::kNotConnected:
      if (!rtu_) close_client(client, false);
      return;
    case BusOutcome::kException:
      return send(client, device_->exception(request, recorded.exception));
    case BusOutcome::kBadReply:
    case BusOutcome::kAnswered:
      break;
  }
  // The recording does not contain the fault of a bad reply.
  const bool is_bad = recorded.outcome == BusOutcome::kBadReply;
  const BatteryFault fault = is_bad ? BatteryFault::kWrongUnit : BatteryFault::kNone;
  send(client, device_->frame(request, content_of(recorded), fault));
}

void BatteryServer::answer_with_fault(Client& client, const BusRequest& request,
                                      BatteryFault fault) {
  switch (fault) {
    case BatteryFault::kSilence:
      return;
    case BatteryFault::kHalfOpen:
      client.half_open = true;
      return;
    case BatteryFault::kDrop:
    case BatteryFault::kReset:
      return close_client(client, fault == BatteryFault::kReset);
    case BatteryFault::kException:
      return send(client, device_->exception(request, settings_.faults.exception_code));
    case BatteryFault::kLate:
      if (!wait(settings_.faults.late_ms)) return;
      break;
    default:
      break;
  }
  const Bytes bytes = device_->answer(request, fault, clock_.now_utc_ns());
  if (fault == BatteryFault::kDrip) return drip(client, bytes);
  if (fault != BatteryFault::kByteGap) return send(client, bytes);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
  send(client, {bytes.begin(), middle});
  if (wait(settings_.faults.late_ms)) send(client, {middle, bytes.end()});
}

void BatteryServer::send(Client& client, const Bytes& bytes) {
  if (client.fd < 0 || bytes.empty()) return;
  const ssize_t sent = rtu_ ? write(client.fd, bytes.data(), bytes.size())
                            : ::send(client.fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0 && !rtu_) close_client(client, false);
}

void BatteryServer::drip(Client& client, const Bytes& bytes) {
  for (const std::uint8_t byte : bytes) {
    if (client.fd < 0 || !wait(settings_.faults.drip_ms)) return;
    send(client, {byte});
  }
}

/// False when a stop was requested.
bool BatteryServer::wait(std::int32_t ms) const {
  pollfd stop{.fd = stop_fd_, .events = POLLIN, .revents = 0};
  return ms <= 0 || poll(&stop, 1, ms) == 0;
}

}  // namespace bess
