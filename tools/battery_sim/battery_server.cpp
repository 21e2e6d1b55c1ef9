#include "tools/battery_sim/battery_server.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "shared/host/user_error.h"
#include "tools/battery_sim/serial_request.h"

namespace bess {
namespace {

constexpr int kByteTimeoutMs = 500;  ///< of a frame on a serial line, as libmodbus has it

}  // namespace

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
  modbus_set_slave(context_.get(), map_.unit);  // libmodbus wants one; all are served
  if (modbus_connect(context_.get()) != 0) {
    fail("{}: cannot open this serial line: {}", settings_.serial_device, std::strerror(errno));
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
    // Clients first: a master that closed and came back must not be refused as the second one.
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

/// False: nothing to answer.
bool BatteryServer::receive(Client& client, BusRequest& request) {
  if (rtu_) {
    const SerialRead read = read_serial_request(client.fd, kByteTimeoutMs, request);
    if (read == SerialRead::kGone) fail("{}: the serial line is gone", settings_.serial_device);
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
  // Another unit, or a connection that has gone dead: silence, as on a bus.
  const bool is_here = recorded_ != nullptr ? recorded_->serves_unit(request.unit())
                                            : device_->serves_unit(request.unit());
  if (!is_here || client.half_open) return;
  if (recorded_ != nullptr) return answer_as_recorded(client, request);
  if (!wait(settings_.response_delay_ms)) return;
  answer_with_fault(client, request, device_->on_request(request, clock_.now_utc_ns()));
}

void BatteryServer::answer_as_recorded(Client& client, const BusRequest& request) {
  const BusExchange recorded = recorded_->answer(request);
  if (!wait(recorded_->latency_ms(recorded))) return;
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
  // What was wrong with a bad reply is not known.
  const bool is_bad = recorded.outcome == BusOutcome::kBadReply;
  const BatteryFault fault = is_bad ? BatteryFault::kWrongUnit : BatteryFault::kNone;
  send(client, device_->frame(request, ReplayedBus::content(recorded), fault));
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
      return send(client, device_->exception(request, settings_.exception_code));
    case BatteryFault::kLate:
      if (!wait(settings_.late_ms)) return;
      break;
    default:
      break;
  }
  const Bytes bytes = device_->answer(request, fault, clock_.now_utc_ns());
  if (fault == BatteryFault::kDrip) return drip(client, bytes);
  if (fault != BatteryFault::kByteGap) return send(client, bytes);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
  send(client, {bytes.begin(), middle});
  if (wait(settings_.late_ms)) send(client, {middle, bytes.end()});
}

void BatteryServer::send(Client& client, const Bytes& bytes) {
  if (client.fd < 0 || bytes.empty()) return;
  const ssize_t sent = rtu_ ? write(client.fd, bytes.data(), bytes.size())
                            : ::send(client.fd, bytes.data(), bytes.size(), MSG_NOSIGNAL);
  if (sent < 0 && !rtu_) close_client(client, false);
}

void BatteryServer::drip(Client& client, const Bytes& bytes) {
  for (const std::uint8_t byte : bytes) {
    if (client.fd < 0 || !wait(settings_.drip_ms)) return;
    send(client, {byte});
  }
}

/// False when the simulator is to stop.
bool BatteryServer::wait(std::int32_t ms) const {
  pollfd stop{.fd = stop_fd_, .events = POLLIN, .revents = 0};
  return ms <= 0 || poll(&stop, 1, ms) == 0;
}

}  // namespace bess
