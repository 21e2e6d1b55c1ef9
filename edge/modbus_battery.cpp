#include "edge/modbus_battery.h"

#include <algorithm>

namespace bess {
namespace {

constexpr int kAttempts = 2;  // a dropped connection is mended once within the cycle

std::int32_t to_int32(std::int64_t value) {
  return static_cast<std::int32_t>(std::clamp<std::int64_t>(value, INT32_MIN, INT32_MAX));
}

}  // namespace

ModbusBattery::ModbusBattery(const BatteryLinkSettings& link, const RegisterMap& map,
                             const ScaledClock& clock)
    : link_(link,
            {.response_timeout_ms = map.response_timeout_ms, .minimum_gap_ms = map.minimum_gap_ms},
            clock),
      map_(map),
      unit_(link.unit >= 0 ? link.unit : map.unit),
      soc_(find_point(map, "soc")),
      power_(find_point(map, "battery_power")),
      capacity_(find_point(map, "capacity")),
      charge_limit_(find_point(map, "charge_power_max")),
      discharge_limit_(find_point(map, "discharge_power_max")),
      temperature_min_(find_point(map, "temperature_min")),
      temperature_max_(find_point(map, "temperature_max")) {
  plan_reads();
}

/// Merges the measured points into as few requests as the map allows.
void ModbusBattery::plan_reads() {
  StaticVector<std::int8_t, 16> order = map_.measure;
  std::sort(order.begin(), order.end(), [this](std::int8_t a, std::int8_t b) {
    return map_.points[a].address < map_.points[b].address;
  });
  const int read_max = std::min(map_.registers_per_read_max, kSpanRegistersMax);
  for (const std::int8_t index : order) {
    const RegisterPoint& point = map_.points[index];
    const int end = point.address + point.register_count();
    if (!spans_.empty()) {
      RegisterSpan& last = spans_[spans_.size() - 1];
      const int gap = point.address - (last.address + last.count);
      if (gap <= map_.read_gap_registers_max && end - last.address <= read_max &&
          last.function == point.read_function) {
        last.count = static_cast<std::uint16_t>(std::max<int>(last.count, end - last.address));
        continue;
      }
    }
    spans_.push_back({.unit = unit_,
                      .address = point.address,
                      .count = static_cast<std::uint16_t>(point.register_count()),
                      .function = point.read_function});
  }
}

Status ModbusBattery::read_point(int point, std::int64_t& value) {
  const RegisterPoint& p = map_.points[point];
  std::uint16_t registers[2] = {};
  const RegisterSpan span{.unit = unit_,
                          .address = p.address,
                          .count = static_cast<std::uint16_t>(p.register_count()),
                          .function = p.read_function};
  const Status status = link_.read(span, registers);
  if (status != Status::kOk) return status;
  return decode(p, registers, value) ? Status::kOk : Status::kImplausible;
}

Status ModbusBattery::read(BatteryMeasurement& measurement) {
  Status status = Status::kOk;
  IdentityFailure failure;
  if (!identified_) status = check_identity(failure);
  if (status != Status::kOk) return status;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    measurement = BatteryMeasurement{};
    status = Status::kOk;
    for (int i = 0; i < spans_.size() && status == Status::kOk; ++i) {
      status = read_span_values(spans_[i], measurement);
    }
    if (status == Status::kOk || status == Status::kImplausible) return status;
  }
  return status;
}

Status ModbusBattery::read_span_values(const RegisterSpan& span, BatteryMeasurement& measurement) {
  std::uint16_t registers[kSpanRegistersMax] = {};
  const Status status = link_.read(span, registers);
  if (status != Status::kOk) return status;
  for (const std::int8_t index : map_.measure) {
    const RegisterPoint& point = map_.points[index];
    const int offset = point.address - span.address;
    if (point.read_function != span.function || offset < 0 || offset >= span.count) continue;
    std::int64_t value = 0;
    if (!decode(point, registers + offset, value)) return Status::kImplausible;
    store(index, value, measurement);
  }
  return Status::kOk;
}

void ModbusBattery::store(int point, std::int64_t value, BatteryMeasurement& measurement) const {
  const std::int32_t narrow = to_int32(value);
  if (point == soc_) measurement.soc_e4 = narrow;
  if (point == power_) measurement.power_w = narrow;
  if (point == capacity_) measurement.capacity_wh = narrow;
  if (point == charge_limit_) measurement.charge_w_max = narrow;
  if (point == discharge_limit_) measurement.discharge_w_max = narrow;
  if (point == temperature_min_) measurement.temperature_min_deci_c = narrow;
  if (point == temperature_max_) measurement.temperature_max_deci_c = narrow;
  if (point == map_.off_grid.point) measurement.off_grid = value == map_.off_grid.value;
  if (point == map_.dead_man_expired.point) {
    measurement.dispatch_active = value != map_.dead_man_expired.value;
  }
  for (const std::int8_t alarm : map_.alarms) {
    if (point == alarm && value != 0) measurement.alarm = true;
  }
}

Status ModbusBattery::order(const PowerOrder& order) {
  return run_command(command_of(order.power_w), order);
}

Status ModbusBattery::release() { return run_command(Command::kRelease, PowerOrder{}); }

Status ModbusBattery::run_command(Command command, const PowerOrder& order) {
  Status status = Status::kOk;
  for (int attempt = 0; attempt < kAttempts; ++attempt) {
    status = run_command_once(command, order);
    if (status == Status::kOk || status == Status::kNotExpressible) return status;
  }
  // Half of a sequence may have been taken: rather the battery's own mode than a mixture.
  if (command != Command::kRelease && map_.sequence(command).writes.size() > 1) {
    static_cast<void>(run_command_once(Command::kRelease, PowerOrder{}));
  }
  return status;
}

Status ModbusBattery::run_command_once(Command command, const PowerOrder& order) {
  const CommandSequence& sequence = map_.sequence(command);
  for (const BlockWrite& write : sequence.writes) {
    RegisterBlock block;
    Status status = encode_block(map_, write, order, block);
    if (status == Status::kOk) {
      status = link_.write(unit_, write.function, write.address, block.data(), block.size());
    }
    if (status != Status::kOk) return status;
  }
  return sequence.read_back ? verify_command(sequence, order) : Status::kOk;
}

/// Everything that the sequence wrote, compared in one read: the writes of a command lie side by
/// side.
Status ModbusBattery::verify_command(const CommandSequence& sequence, const PowerOrder& order) {
  int begin = UINT16_MAX;
  int end = 0;
  RegisterBlock blocks[decltype(sequence.writes)::capacity()];
  for (int i = 0; i < sequence.writes.size(); ++i) {
    const Status status = encode_block(map_, sequence.writes[i], order, blocks[i]);
    if (status != Status::kOk) return status;
    begin = std::min<int>(begin, sequence.writes[i].address);
    end = std::max(end, sequence.writes[i].address + blocks[i].size());
  }
  if (end - begin > kSpanRegistersMax) return Status::kTooLarge;
  std::uint16_t registers[kSpanRegistersMax] = {};
  const RegisterSpan span{.unit = unit_,
                          .address = static_cast<std::uint16_t>(begin),
                          .count = static_cast<std::uint16_t>(end - begin)};
  const Status status = link_.read(span, registers);
  if (status != Status::kOk) return status;
  for (int i = 0; i < sequence.writes.size(); ++i) {
    const int offset = sequence.writes[i].address - begin;
    if (!std::equal(blocks[i].begin(), blocks[i].end(), registers + offset)) {
      return Status::kNotApplied;
    }
  }
  return Status::kOk;
}

Status ModbusBattery::check_identity(IdentityFailure& failure) {
  for (failure.check = 0; failure.check < map_.identity.size(); ++failure.check) {
    const IdentityCheck& check = map_.identity[failure.check];
    Status status = read_point(check.point, failure.value);
    if (status != Status::kOk && status != Status::kImplausible) {
      status = read_point(check.point, failure.value);  // a dropped connection is mended once
    }
    if (status != Status::kOk) return status;
    const bool fits = failure.value >= check.value_min && failure.value <= check.value_max;
    if (!fits) return Status::kImplausible;
  }
  identified_ = true;
  return Status::kOk;
}

}  // namespace bess
