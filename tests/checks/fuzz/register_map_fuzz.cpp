// Register maps: an accepted map keeps its promises about the power it can express, and the driver
// can run it against a device that gives arbitrary answers.
#include "edge/device/battery/battery_driver.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/device/registers/codec.h"
#include "edge/device/registers/map_file.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "tests/checks/fuzz/scratch_file.h"

namespace bess {
namespace {

/// Answers every read with one repeated value, and accepts every write.
class AnyDevice {
 public:
  explicit AnyDevice(std::uint16_t answer) : answer_(answer) {}
  Status read(const RegisterSpan& span, std::uint16_t* registers) {
    must(span.count > 0 && span.count <= kSpanRegistersMax, "a read has its size");
    std::fill_n(registers, span.count, answer_);
    return Status::kOk;
  }
  Status write(std::int32_t, std::uint8_t function, std::uint16_t, const std::uint16_t*, int count,
               std::int64_t) {
    must(count > 0 && count <= kBlockRegistersMax, "a write has its size");
    must(function == 16 || (function == 6 && count == 1), "a write has its function");
    return Status::kOk;
  }
  void close() {}
  [[nodiscard]] int last_exception() const { return 0; }
  [[nodiscard]] BatteryCounters counters() const { return {}; }

 private:
  std::uint16_t answer_;
};

class AnyTime {
 public:
  std::int64_t now_ns() const { return ++now_ns_; }
  void sleep_ms(std::int32_t ms) const { now_ns_ += std::int64_t{ms} * 1'000'000; }
  static std::int64_t utc_day() { return 20'000; }

 private:
  mutable std::int64_t now_ns_ = 1;
};

void drive(const RegisterMap& map, std::uint16_t answer) {
  BatteryDriver<AnyDevice, AnyTime> driver(map, AnyTime(), -1, answer);
  BatteryMeasurement measurement;
  for (const std::int32_t power_w : {1, 0, -map.discharge_w_max}) {
    static_cast<void>(driver.read(measurement));
    static_cast<void>(driver.order({.power_w = power_w, .duration_s = map.watchdog.duration_s}));
    static_cast<void>(driver.refresh());
  }
  static_cast<void>(driver.release());
}

void read_meter(const RegisterMap& map, std::uint16_t answer) {
  GridMeter<AnyDevice, AnyTime> meter(map, AnyTime(), -1, answer);
  std::int32_t grid_power_w = 0;
  static_cast<void>(meter.read(grid_power_w));
  static_cast<void>(meter.read(grid_power_w));
}

}  // namespace
}  // namespace bess

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  static const ScratchFile file("map.toml");
  const std::string path = file.holding(text_of(data, size));
  static RegisterMap map;
  std::string error;
  const bool ok = load_register_map(path, "", map, error);
  must(ok == error.empty(), "refused with a reason, accepted without");
  must(error.find('\n') == std::string::npos, "one line");
  if (!ok) return 0;
  constexpr std::uint16_t kAnswers[] = {0x0000, 0x0001, 0x8000, 0xFFFF};
  must(measure_grid_power(map) || !map.is_meter, "a meter has a grid power");
  if (map.is_meter) {
    for (const std::uint16_t answer : kAnswers) read_meter(map, answer);
    return 0;
  }
  must(map.charge_w_max > 0 && map.discharge_w_max > 0, "an accepted map can express power");
  for (const std::int32_t power_w : {map.charge_w_max, 0, -map.discharge_w_max}) {
    const PowerOrder order{.power_w = power_w, .duration_s = map.watchdog.duration_s};
    must(check_expressible(map, order) == Status::kOk,
         "the power it states goes into its registers");
  }
  for (const std::uint16_t answer : kAnswers) drive(map, answer);
  return 0;
}
