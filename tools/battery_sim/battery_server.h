// The Modbus TCP side of the simulated battery: libmodbus frames, one client at a time like the
// real device, and faults on demand.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "edge/registers/register_map.h"
#include "shared/scaled_clock.h"
#include "tools/battery_sim/register_image.h"
#include "tools/battery_sim/simulated_battery.h"

struct _modbus;
struct _modbus_mapping_t;

namespace bess {

enum class BatteryFault : std::uint8_t {
  kNone,
  kSilence,           ///< no answer
  kLate,              ///< the answer comes after `late_ms`
  kException,         ///< exception 6, busy
  kDrop,              ///< the connection is closed instead of answering
  kAckWithoutEffect,  ///< a write is acknowledged and forgotten
};

struct BatteryServerSettings {
  std::string host = "127.0.0.1";
  std::int32_t port = 1502;  ///< 0 = any free one
  std::int32_t response_delay_ms = 0;
  BatteryFault fault = BatteryFault::kNone;
  std::int32_t fault_every = 10;  ///< every Nth request (write, for kAckWithoutEffect)
  std::int32_t late_ms = 1'500;
};

class BatteryServer {
 public:
  /// Binds and listens. Throws SimError when the port is in use.
  BatteryServer(const BatteryServerSettings& settings, const RegisterMap& map,
                SimulatedBattery& battery, const ScaledClock& clock);
  BatteryServer(const BatteryServer&) = delete;
  BatteryServer& operator=(const BatteryServer&) = delete;
  ~BatteryServer();

  [[nodiscard]] int port() const { return port_; }
  /// Serves until `stop_fd` becomes readable.
  void run(int stop_fd);

 private:
  struct Request;
  struct FreeContext {
    void operator()(_modbus* context) const;
  };
  struct FreeMapping {
    void operator()(_modbus_mapping_t* mapping) const;
  };
  void accept_client();
  void close_client();
  void serve_request();
  [[nodiscard]] bool is_faulty(const Request& request);
  void answer(const Request& request);
  void misbehave(const Request& request);

  BatteryServerSettings settings_;
  const RegisterMap& map_;
  SimulatedBattery& battery_;
  ScaledClock clock_;
  std::unique_ptr<_modbus, FreeContext> context_;
  std::unique_ptr<_modbus_mapping_t, FreeMapping> mapping_;
  std::unique_ptr<RegisterImage> image_;
  int listen_fd_ = -1;
  int client_fd_ = -1;
  int port_ = 0;
  std::int64_t fault_candidates_ = 0;
};

}  // namespace bess
