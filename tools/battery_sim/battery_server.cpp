#include "tools/battery_sim/battery_server.h"

#include <arpa/inet.h>
#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "edge/registers/codec.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr int kAddressPage = 0x1000;

/// Addresses are served up to the end of the last point's page: beyond is "illegal data address".
int served_addresses(const RegisterMap& map) {
  const int end = RegisterImage::address_end(map);
  return std::min((end + kAddressPage - 1) / kAddressPage * kAddressPage, 0x1'0000);
}

bool has_input_registers(const RegisterMap& map) {
  return std::any_of(map.points.begin(), map.points.end(),
                     [](const RegisterPoint& p) { return p.read_function == 4; });
}

bool serves_unit(const RegisterMap& map, int unit) {
  return unit == map.unit || std::any_of(map.unit_groups.begin(), map.unit_groups.end(),
                                         [unit](const UnitGroup& g) { return g.unit == unit; });
}

}  // namespace

BatteryServer::BatteryServer(const BatteryServerSettings& settings, const RegisterMap& map,
                             SimulatedBattery& battery, const ScaledClock& clock,
                             MeteredHouse* house)
    : settings_(settings),
      rtu_(!settings.serial_device.empty()),
      map_(map),
      battery_(battery),
      house_(house),
      clock_(clock),
      start_ns_(clock.now_utc_ns()),
      plan_(settings.faults, rtu_) {
  context_.reset(rtu_ ? modbus_new_rtu(settings.serial_device.c_str(), settings.baud,
                                       settings.parity, 8, settings.stop_bits)
                      : modbus_new_tcp(settings.host.c_str(), settings.port));
  if (context_ == nullptr) fail("no memory for libmodbus");
  make_registers();
  reply_ = std::make_unique<BusReply>(context_.get(), rtu_);
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

/// Holding and input registers of one address are two things on some devices.
void BatteryServer::make_registers() {
  registers_.resize(static_cast<std::size_t>(served_addresses(map_)));
  input_registers_.resize(registers_.size());
  mapping_.nb_registers = static_cast<int>(registers_.size());
  mapping_.tab_registers = registers_.data();
  mapping_.nb_input_registers = has_input_registers(map_) ? mapping_.nb_registers : 0;
  mapping_.tab_input_registers = input_registers_.data();
  image_ = std::make_unique<RegisterImage>(map_, battery_, registers_, input_registers_);
  if (house_ != nullptr) image_->connect_house(house_->load);
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
  modbus_set_slave(context_.get(), map_.unit);  // requests to other units are not even seen
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
  const auto plant = hold_plant();
  battery_.advance(clock_.now_utc_ns());
}

std::unique_lock<std::mutex> BatteryServer::hold_plant() const {
  return house_ == nullptr ? std::unique_lock<std::mutex>() : std::unique_lock(house_->plant);
}

void BatteryServer::refresh() {
  const auto plant = hold_plant();
  image_->refresh(clock_.now_utc_ns());
}

void BatteryServer::accept_client() {
  Client client{.fd = accept4(listen_fd_, nullptr, nullptr, SOCK_CLOEXEC)};
  if (client.fd < 0) return;
  const bool full = static_cast<int>(clients_.size()) >= settings_.clients_max;
  const BatteryFault fault = plan_.draw(FaultChance::kConnect, elapsed_s());
  if (full || fault == BatteryFault::kRefuse) return close_client(client, false);
  clients_.push_back(client);
}

void BatteryServer::close_client(Client& client, bool reset) {
  const linger at_once{.l_onoff = 1, .l_linger = 0};  // closing then sends RST
  if (reset) setsockopt(client.fd, SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
  close(client.fd);
  client.fd = -1;
}

void BatteryServer::serve(Client& client) {
  BusRequest request{};
  request.header = rtu_ ? 0 : kTcpHeaderBytes;
  modbus_set_socket(context_.get(), client.fd);
  request.size = modbus_receive(context_.get(), request.bytes);
  if (request.size < 0) {
    if (!rtu_) return close_client(client, false);
    if (errno == EIO || errno == EBADF || errno == ECONNRESET) {
      fail("{}: the serial line is gone", settings_.serial_device);
    }
    modbus_flush(context_.get());
    return;
  }
  // Another unit, or a connection that has gone dead: silence, as on a bus.
  const bool is_here = recorded_ != nullptr ? recorded_->serves_unit(request.unit())
                                            : serves_unit(map_, request.unit());
  if (request.size == 0 || !is_here || client.half_open) return;
  if (recorded_ != nullptr) return answer_as_recorded(client, request);
  if (wait(settings_.response_delay_ms)) answer(client, request);
}

void BatteryServer::answer(Client& client, const BusRequest& request) {
  apply_lasting_faults();
  const FaultChance chance = request.is_write() ? FaultChance::kWrite : FaultChance::kRead;
  const BatteryFault fault = plan_.draw(chance, elapsed_s());
  if (fault != BatteryFault::kFrozen) refresh();
  answer_with_fault(client, request, fault);
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
      return send(client, reply_->exception(request, recorded.exception));
    case BusOutcome::kBadReply:
    case BusOutcome::kAnswered:
      break;
  }
  const Bytes bytes = reply_->frame(request, ReplayedBus::content(recorded));
  const bool is_bad =
      recorded.outcome == BusOutcome::kBadReply;  // what was wrong with it is not known
  send(client,
       is_bad ? reply_->spoil(request, bytes, BatteryFault::kWrongUnit, plan_.random()) : bytes);
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
      return send(client, reply_->exception(request, settings_.exception_code));
    case BatteryFault::kLate:
      if (!wait(settings_.late_ms)) return;
      refresh();
      break;
    default:
      change_values(fault);
      break;
  }
  const Bytes right = right_answer(request, fault == BatteryFault::kAckWithoutEffect);
  const Bytes bytes = reply_->spoil(request, right, fault, plan_.random());
  if (fault == BatteryFault::kDrip) return drip(client, bytes);
  if (fault != BatteryFault::kByteGap) return send(client, bytes);
  const auto middle = bytes.begin() + static_cast<std::ptrdiff_t>(bytes.size() / 2);
  send(client, {bytes.begin(), middle});
  if (wait(settings_.late_ms)) send(client, {middle, bytes.end()});
}

/// From the request after --fault-from-s on; what another master did between two requests is done late.
void BatteryServer::apply_lasting_faults() {
  if (map_.is_meter) return;
  const auto plant = hold_plant();
  const auto lasts = [&](BatteryFault fault) { return plan_.lasts(fault, elapsed_s()); };
  const double rated_w = battery_.parameters().power_w_max;
  const std::int64_t now_ns = clock_.now_utc_ns();
  battery_.advance(now_ns);
  battery_.set_habits({.gain = lasts(BatteryFault::kPartPower)     ? 0.3
                               : lasts(BatteryFault::kExcessPower) ? 2.0
                                                                   : 1.0,
                       .idle_power_w = lasts(BatteryFault::kIdleDischarge) ? -0.75 * rated_w : 0.0,
                       .delay_s = lasts(BatteryFault::kSlowAndNoisy) ? 5.0 : 0.0,
                       .noise_frac = lasts(BatteryFault::kSlowAndNoisy) ? 0.02 : 0.0,
                       .slows_near_limits = lasts(BatteryFault::kThrottle)});
  image_->set_display({.soc_stands_still = lasts(BatteryFault::kSocStuck),
                       .capacity_factor = lasts(BatteryFault::kOtherCapacity) ? 5.0 : 1.0});
  if (!lasts(BatteryFault::kOtherMaster)) return;
  constexpr std::int64_t kForeignIntervalNs = 30 * kNanosecondsPerSecond;
  if (now_ns < next_foreign_order_ns_) return;
  next_foreign_order_ns_ = now_ns + kForeignIntervalNs;
  image_->refresh(now_ns);
  image_->order_from_outside(-static_cast<std::int32_t>(rated_w));
}

/// What a healthy battery answers, and what a write does to it.
Bytes BatteryServer::right_answer(const BusRequest& request, bool keep_registers) {
  std::vector<std::uint16_t> before;
  if (keep_registers) before = registers_;
  Bytes bytes = reply_->answer(request, mapping_);
  if (keep_registers) {
    std::copy(before.begin(), before.end(), registers_.begin());  // image_ holds a view
  } else if (request.is_write() &&
             request.address() + request.write_count() <= mapping_.nb_registers) {
    const auto plant = hold_plant();
    image_->apply_write(request.address(), request.write_count());
  }
  return bytes;
}

void BatteryServer::change_values(BatteryFault fault) {
  const auto change = [this](const char* name, auto&& changed) {
    const int index = find_point(map_, name);
    if (index < 0) return;
    const RegisterPoint& point = map_.points[index];
    std::int64_t value = 0;
    RegisterBlock block;
    const int address = image_->address_of(index);
    auto& registers = point.read_function == 4 ? input_registers_ : registers_;
    static_cast<void>(decode(point, &registers[address], value));
    if (encode(point, changed(value), Rounding::kNearest, block) != Status::kOk) return;
    std::copy(block.begin(), block.end(), registers.begin() + address);
  };
  if (fault == BatteryFault::kWrongSign) {
    change(map_.is_meter ? "grid_power" : "battery_power",
           [](std::int64_t power_w) { return -power_w; });
  }
  if (fault == BatteryFault::kSocJump) {
    change("soc", [](std::int64_t soc_e4) { return (soc_e4 + 5'000) % 10'000; });
  }
  if (fault == BatteryFault::kEarlyExpiry) {
    const auto plant = hold_plant();
    battery_.stop_dispatch();
    image_->refresh(clock_.now_utc_ns());
  }
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

double BatteryServer::elapsed_s() const {
  return static_cast<double>(clock_.now_utc_ns() - start_ns_) / 1e9;
}

}  // namespace bess
