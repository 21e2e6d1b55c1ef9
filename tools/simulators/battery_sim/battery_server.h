// Bus server of the simulated battery, TCP or serial line: receives requests, lets the device
// answer, and injects scheduled faults. By default one client at a time, like the real device.
#pragma once

#include <modbus/modbus.h>

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"
#include "shared/scaled_clock.h"
#include "tools/simulators/battery_sim/battery_faults.h"
#include "tools/simulators/battery_sim/bus_reply.h"
#include "tools/simulators/battery_sim/faulty_device.h"
#include "tools/simulators/battery_sim/recorded_device.h"

namespace bess {

// Requests on a serial line: complete frames for any unit. libmodbus reads frames of one unit only,
// and takes the frame after a request to another unit for its reply.

enum class SerialRead : std::uint8_t {
  kRequest,
  kNoise,  ///< incomplete in time, or wrong CRC: input is discarded
  kGone,   ///< the line has disappeared
};

/// Waits `byte_timeout_ms` for each next byte of a frame. Functions 3, 4, 6 and 16 have a known
/// length; other frames end with this silence.
SerialRead read_serial_request(int fd, int byte_timeout_ms, BusRequest& request);

struct BatteryServerSettings {
  std::string host = "127.0.0.1";
  std::int32_t port = 1502;  ///< 0: any free port
  std::int32_t clients_max = 1;
  std::string serial_device{};  ///< not empty: RTU instead of TCP
  std::int32_t baud = 9'600;
  char parity = 'N';
  std::int32_t stop_bits = 1;
  std::int32_t response_delay_ms = 0;
  FaultSchedule faults{};
};

class BatteryServer {
 public:
  /// Binds and listens, or opens the line. Throws UserError when the port is in use.
  /// With a house the grid point of the map includes it; a meter map makes this a meter.
  BatteryServer(const BatteryServerSettings& settings, const RegisterMap& map,
                SimulatedBattery& battery, const ScaledClock& clock, MeteredHouse* house = nullptr);
  BatteryServer(const BatteryServer&) = delete;
  BatteryServer& operator=(const BatteryServer&) = delete;
  ~BatteryServer();

  [[nodiscard]] int port() const { return port_; }
  /// Answers all further requests as recorded; the registers are unchanged. In simulated time a
  /// request has the time of the recording; in real time the first request corresponds to its first
  /// exchange. `recorded` must outlive this object.
  void replay(RecordedDevice& recorded) { recorded_ = &recorded; }
  /// Serves until `stop_fd` becomes readable. Throws UserError when the serial line disappears.
  void run(int stop_fd);

 private:
  struct Client {
    int fd;
    bool half_open = false;
  };
  void listen_tcp();
  void open_serial();
  void accept_client();
  [[nodiscard]] bool receive(Client& client, BusRequest& request);
  void serve(Client& client);
  BusExchange recorded_answer(const BusRequest& request);
  void answer_as_recorded(Client& client, const BusRequest& request);
  void answer_with_fault(Client& client, const BusRequest& request, BatteryFault fault);
  void send(Client& client, const Bytes& bytes);
  void drip(Client& client, const Bytes& bytes);
  void close_client(Client& client, bool reset);
  [[nodiscard]] bool wait(std::int32_t ms) const;

  BatteryServerSettings settings_;
  bool rtu_;
  const RegisterMap& map_;
  RecordedDevice* recorded_ = nullptr;  ///< null: the registers answer
  /// From now to the time of the recording; empty: it has not begun.
  std::optional<std::int64_t> shift_ns_;
  ScaledClock clock_;
  ModbusContext context_;
  std::optional<FaultyDevice> device_;
  std::vector<Client> clients_;
  int listen_fd_ = -1;
  int stop_fd_ = -1;
  int port_ = 0;
};

}  // namespace bess
