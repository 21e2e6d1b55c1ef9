// Register device in memory, with the link and the time through which the battery driver reaches it
// without sockets: every write is recorded; the test sets faults and time.
#pragma once

#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <string>
#include <vector>

#include "edge/device/battery/battery_driver.h"
#include "edge/device/battery/modbus_link.h"
#include "tests/support/shipped_maps.h"

namespace bess {

struct WriteRecord {
  int unit, function, address;
  std::vector<int> values;
  friend bool operator==(const WriteRecord&, const WriteRecord&) = default;
  friend void PrintTo(const WriteRecord& w, std::ostream* out) {
    *out << "unit " << w.unit << " function " << w.function << " address " << w.address << ":";
    for (const int value : w.values) *out << " " << value;
  }
};

/// An expected write by function 16 or 6.
inline WriteRecord fc16(int address, std::vector<int> values, int unit = 1) {
  return {unit, 16, address, std::move(values)};
}
inline WriteRecord fc6(int address, int value) { return {1, 6, address, {value}}; }

/// A register that the device lacks: a read that includes it is refused.
struct MissingRegister {
  int function = 3;
  int address = 0;
  int exception = 2;  ///< exception code of the refusal; -1 = no answer
};

struct RegisterDevice {
  std::vector<std::uint16_t> holding = std::vector<std::uint16_t>(0x1'0000);
  std::vector<std::uint16_t> input = std::vector<std::uint16_t>(0x1'0000);
  std::vector<WriteRecord> writes;  ///< every request, executed or not
  int reads = 0;
  int reconnects = 0;
  std::int64_t now_ns = 1;  ///< the device's time, set by the test
  std::int64_t day = 20'000;
  bool ignores_writes = false;  ///< acknowledges, does nothing
  int exception = 0;            ///< exception code of every request; -1 = no answer
  int unreadable_address = -1;  ///< a read that includes it is not answered
  std::vector<MissingRegister> missing;
  int refused_reads = 0;
  int refused_single = 0;  ///< function that writes no single register: exception 2
  int failing_writes = 0;  ///< number of next writes that are not answered
  std::function<void(std::int64_t ns)> sleep = [this](std::int64_t ns) { now_ns += ns; };
  std::function<void()> before_request = [] {};
  std::function<void(int address, int count)> after_write = [](int, int) {};

  void set(int address, const std::vector<int>& values) {
    for (const int value : values) holding[address++] = static_cast<std::uint16_t>(value);
  }
  void set_input(int address, const std::vector<int>& values) {
    for (const int value : values) input[address++] = static_cast<std::uint16_t>(value);
  }
  void pass_s(double seconds) { now_ns += static_cast<std::int64_t>(seconds * 1e9); }
  std::vector<WriteRecord> take_writes() { return std::exchange(writes, {}); }
};

/// Registers of alphaess.toml at 43.5 % of 8 kWh, on grid.
inline void fill_alphaess(RegisterDevice& device) {
  device.set(0x0102, {435});
  device.set(0x0119, {80});
  device.set(0x012C, {4'000, 3'500});
  device.set(0x0440, {1});
}
/// Registers of victron_ess3.toml at 62 %, charging.
inline void fill_victron(RegisterDevice& device) {
  device.set(842, {1'500, 62});
  device.set(2'902, {1});
}

inline void fill_fronius(RegisterDevice& device) {
  device.set(40'253, {160});
  device.set(40'314, {1'200});  // module 3 charges
  device.set(40'343, {124});
  device.set(40'345, {5'000});   // WChaMax
  device.set(40'351, {4'700});   // SoC 47.00 %
  device.set(40'365, {0xFFFE});  // scale -2
  device.set(40'368, {0xFFFE});
}

inline void fill_huawei(RegisterDevice& device) {
  device.set(37'046, {0, 5'000, 0, 4'500});
  device.set(37'758, {0, 10'000, 505});
  device.set(37'765, {0xFFFF, 0xFA24});  // -1500: discharging
  device.set(47'075, {0, 5'000, 0, 2'500});
}

inline void fill_sungrow(RegisterDevice& device) {
  device.set_input(13'000, {2});
  device.set_input(13'021, {1'500, 505});
  device.set_input(13'024, {215});
  device.set(33'046, {500, 450});
}

class DeviceLink {
 public:
  explicit DeviceLink(RegisterDevice& device) : device_(device) {}

  Status read(const RegisterSpan& span, std::uint16_t* registers) {
    ++device_.reads;
    last_exception_ = 0;
    ++counters_.requests;
    device_.before_request();
    if (const Status status = fault(); status != Status::kOk) return status;
    const auto is_read = [&](int address) {
      return address >= span.address && address < span.address + span.count;
    };
    if (is_read(device_.unreadable_address)) return Status::kTimeout;
    for (const MissingRegister& missing : device_.missing) {
      if (missing.function != span.function || !is_read(missing.address)) continue;
      ++device_.refused_reads;
      if (missing.exception < 0) return Status::kTimeout;
      last_exception_ = missing.exception;
      return Status::kBusException;
    }
    const auto& table = span.function == 4 ? device_.input : device_.holding;
    std::copy_n(table.begin() + span.address, span.count, registers);
    return Status::kOk;
  }
  Status write(std::int32_t unit, std::uint8_t function, std::uint16_t address,
               const std::uint16_t* registers, int count, std::int64_t send_until_ns) {
    ++counters_.requests;
    last_exception_ = 0;
    device_.before_request();
    if (device_.now_ns > send_until_ns) return Status::kTooLate;
    ++counters_.register_writes;
    device_.writes.push_back({unit, function, address, {registers, registers + count}});
    if (device_.failing_writes > 0) {
      --device_.failing_writes;
      return Status::kTimeout;
    }
    if (const Status status = fault(); status != Status::kOk) return status;
    if (count == 1 && function == device_.refused_single) {
      last_exception_ = 2;
      return Status::kBusException;
    }
    if (device_.ignores_writes) return Status::kOk;
    std::copy_n(registers, count, device_.holding.begin() + address);
    device_.after_write(address, count);
    return Status::kOk;
  }
  void close() {}
  [[nodiscard]] int last_exception() const { return last_exception_; }
  [[nodiscard]] BatteryCounters counters() const {
    BatteryCounters counters = counters_;
    counters.reconnects = device_.reconnects;
    return counters;
  }

 private:
  Status fault() {
    if (device_.exception < 0) return Status::kTimeout;
    last_exception_ = device_.exception;
    return device_.exception > 0 ? Status::kBusException : Status::kOk;
  }

  RegisterDevice& device_;
  BatteryCounters counters_;
  int last_exception_ = 0;
};

class DeviceClock {
 public:
  explicit DeviceClock(RegisterDevice& device) : device_(&device) {}
  [[nodiscard]] std::int64_t now_ns() const { return device_->now_ns; }
  void sleep_ms(std::int32_t ms) const { device_->sleep(std::int64_t{ms} * 1'000'000); }
  [[nodiscard]] std::int64_t utc_day() const { return device_->day; }

 private:
  RegisterDevice* device_;
};

using DeviceDriver = BatteryDriver<DeviceLink, DeviceClock>;

/// A map of edge/device/maps with a device for it; the test fills the registers.
struct MapUnderTest {
  RegisterMap map;
  RegisterDevice device;
  std::unique_ptr<DeviceDriver> driver;
  BatteryMeasurement measured;

  explicit MapUnderTest(const std::string& path, const std::string& variant = "")
      : map(load_good_map(path, variant)) {
    driver = std::make_unique<DeviceDriver>(map, DeviceClock(device), -1, device);
  }
  MapUnderTest(const std::string& path, void (*fill)(RegisterDevice&)) : MapUnderTest(path) {
    fill(device);
  }
  Status order(std::int32_t power_w) {
    return driver->order({.power_w = power_w,
                          .soc_min_e4 = 1'000,
                          .soc_max_e4 = 9'000,
                          .duration_s = map.watchdog.duration_s});
  }
  Status read() { return driver->read(measured); }
  /// Findings of a reading that must succeed.
  const BatteryMeasurement& reading() {
    EXPECT_EQ(read(), Status::kOk);
    return measured;
  }
  /// Writes of an order, a release, a refresh that must succeed.
  std::vector<WriteRecord> writes_of(std::int32_t power_w) { return writes_after(order(power_w)); }
  std::vector<WriteRecord> release_writes() { return writes_after(driver->release()); }
  std::vector<WriteRecord> refresh_writes() { return writes_after(driver->refresh()); }

 private:
  std::vector<WriteRecord> writes_after(Status status) {
    EXPECT_EQ(status, Status::kOk);
    return device.take_writes();
  }
};

}  // namespace bess
