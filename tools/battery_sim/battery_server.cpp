#include "tools/battery_sim/battery_server.h"

#include <arpa/inet.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <thread>
#include <vector>

#include "tools/battery_sim/register_image.h"
#include "tools/sim/sim_error.h"

namespace bess {

/// One Modbus TCP request: 7 bytes of MBAP header (the last is the unit), then function and
/// address.
struct BatteryServer::Request {
  std::uint8_t bytes[MODBUS_TCP_MAX_ADU_LENGTH];
  int size;

  [[nodiscard]] int unit() const { return bytes[6]; }
  [[nodiscard]] int function() const { return bytes[7]; }
  [[nodiscard]] int address() const { return bytes[8] << 8 | bytes[9]; }
  [[nodiscard]] bool is_write() const { return function() == 6 || function() == 16; }
  [[nodiscard]] int write_count() const {
    return function() == 16 ? bytes[10] << 8 | bytes[11] : 1;
  }
};

void BatteryServer::FreeContext::operator()(_modbus* context) const { modbus_free(context); }

void BatteryServer::FreeMapping::operator()(_modbus_mapping_t* mapping) const {
  modbus_mapping_free(mapping);
}

BatteryServer::BatteryServer(const BatteryServerSettings& settings, const RegisterMap& map,
                             SimulatedBattery& battery, const ScaledClock& clock)
    : settings_(settings), map_(map), battery_(battery), clock_(clock) {
  context_.reset(modbus_new_tcp(settings.host.c_str(), settings.port));
  mapping_.reset(modbus_mapping_new(0, 0, RegisterImage::kRegisterCount, 0));
  if (context_ == nullptr || mapping_ == nullptr) sim_fail("no memory for libmodbus");
  listen_fd_ = modbus_tcp_listen(context_.get(), 4);
  if (listen_fd_ < 0) {
    const int error = errno;
    sim_fail("cannot listen on {}:{}: {}", settings.host, settings.port,
             error == EADDRINUSE ? "the port is in use; choose another with --port"
                                 : std::strerror(error));
  }
  sockaddr_in address{};
  socklen_t size = sizeof address;
  getsockname(listen_fd_, reinterpret_cast<sockaddr*>(&address), &size);
  port_ = ntohs(address.sin_port);
  const std::span registers(mapping_->tab_registers, std::size_t{RegisterImage::kRegisterCount});
  image_ = std::make_unique<RegisterImage>(map_, battery_, registers);
}

BatteryServer::~BatteryServer() {
  close_client();
  if (listen_fd_ >= 0) close(listen_fd_);
}

void BatteryServer::run(int stop_fd) {
  while (true) {
    pollfd events[3] = {{.fd = stop_fd, .events = POLLIN, .revents = 0},
                        {.fd = listen_fd_, .events = POLLIN, .revents = 0},
                        {.fd = client_fd_, .events = POLLIN, .revents = 0}};
    if (poll(events, 3, -1) < 0 && errno != EINTR) return;
    if (events[0].revents != 0) break;
    // The client first: a master that closed and came back must not be refused as the second one.
    if (events[2].revents != 0) serve_request();
    if (events[1].revents != 0) accept_client();
  }
  battery_.advance(clock_.now_utc_ns());
}

void BatteryServer::accept_client() {
  if (client_fd_ < 0) {
    client_fd_ = modbus_tcp_accept(context_.get(), &listen_fd_);
    return;
  }
  const int second = accept(listen_fd_, nullptr, nullptr);
  if (second >= 0) close(second);  // one client only, like the real device
}

void BatteryServer::close_client() {
  if (client_fd_ >= 0) close(client_fd_);
  client_fd_ = -1;
  modbus_set_socket(context_.get(), -1);
}

void BatteryServer::serve_request() {
  Request request{};
  request.size = modbus_receive(context_.get(), request.bytes);
  if (request.size < 0) return close_client();
  if (request.size == 0 || request.unit() != map_.unit)
    return;  // another unit: silence, as on a bus
  const std::int32_t delay_ms = settings_.response_delay_ms;
  if (delay_ms > 0) std::this_thread::sleep_for(std::chrono::milliseconds(delay_ms));
  if (is_faulty(request)) {
    misbehave(request);
  } else {
    answer(request);
  }
}

bool BatteryServer::is_faulty(const Request& request) {
  if (settings_.fault == BatteryFault::kNone) return false;
  if (settings_.fault == BatteryFault::kAckWithoutEffect && !request.is_write()) return false;
  return ++fault_candidates_ % settings_.fault_every == 0;
}

void BatteryServer::answer(const Request& request) {
  image_->refresh(clock_.now_utc_ns());
  const int sent = modbus_reply(context_.get(), request.bytes, request.size, mapping_.get());
  if (sent < 0) return close_client();
  const bool in_range =
      request.address() + request.write_count() <= int{RegisterImage::kRegisterCount};
  if (request.is_write() && in_range) image_->apply_write(request.address(), request.write_count());
}

void BatteryServer::misbehave(const Request& request) {
  switch (settings_.fault) {
    case BatteryFault::kNone:
    case BatteryFault::kSilence:
      return;
    case BatteryFault::kLate:
      std::this_thread::sleep_for(std::chrono::milliseconds(settings_.late_ms));
      return answer(request);
    case BatteryFault::kException:
      modbus_reply_exception(context_.get(), request.bytes, MODBUS_EXCEPTION_SLAVE_OR_SERVER_BUSY);
      return;
    case BatteryFault::kDrop:
      return close_client();
    case BatteryFault::kAckWithoutEffect:
      break;
  }
  image_->refresh(clock_.now_utc_ns());
  const std::vector<std::uint16_t> before(mapping_->tab_registers,
                                          mapping_->tab_registers + RegisterImage::kRegisterCount);
  if (modbus_reply(context_.get(), request.bytes, request.size, mapping_.get()) < 0) close_client();
  std::copy(before.begin(), before.end(), mapping_->tab_registers);
}

}  // namespace bess
