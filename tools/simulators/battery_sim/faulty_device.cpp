#include "tools/simulators/battery_sim/faulty_device.h"

#include <algorithm>
#include <utility>

#include "edge/device/registers/codec.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr int kAddressPage = 0x1000;

/// Addresses up to the end of the last point's page; beyond: "illegal data address".
int served_addresses(const RegisterMap& map) {
  const int end = RegisterImage::address_end(map);
  return std::min((end + kAddressPage - 1) / kAddressPage * kAddressPage, 0x1'0000);
}

bool has_input_registers(const RegisterMap& map) {
  return std::any_of(map.points.begin(), map.points.end(),
                     [](const RegisterPoint& p) { return p.read_function == 4; });
}

}  // namespace

FaultyDevice::FaultyDevice(const RegisterMap& map, SimulatedBattery& battery, modbus_t* context,
                           const std::vector<FaultSchedule>& faults, bool rtu,
                           std::int64_t start_utc_ns, MeteredHouse* house)
    : map_(map),
      battery_(battery),
      house_(house),
      start_utc_ns_(start_utc_ns),
      registers_(static_cast<std::size_t>(served_addresses(map))),
      input_registers_(registers_.size()),
      image_(map, battery, registers_, input_registers_),
      reply_(context, rtu),
      plan_(faults, rtu),
      next_action_ns_(start_utc_ns) {
  mapping_.nb_registers = static_cast<int>(registers_.size());
  mapping_.tab_registers = registers_.data();
  // Some devices have different holding and input registers at one address.
  mapping_.nb_input_registers = has_input_registers(map) ? mapping_.nb_registers : 0;
  mapping_.tab_input_registers = input_registers_.data();
  if (house != nullptr) image_.connect_house(house->load);
}

bool FaultyDevice::serves_unit(int unit) const {
  return unit == map_.unit || std::any_of(map_.unit_groups.begin(), map_.unit_groups.end(),
                                          [unit](const UnitGroup& g) { return g.unit == unit; });
}

BatteryFault FaultyDevice::on_connect(std::int64_t utc_ns) {
  return plan_.draw(FaultChance::kConnect, elapsed_s(utc_ns));
}

BatteryFault FaultyDevice::on_request(const BusRequest& request, std::int64_t utc_ns) {
  live_until(utc_ns);
  const FaultChance chance = request.is_write() ? FaultChance::kWrite : FaultChance::kRead;
  const BatteryFault fault = plan_.draw(chance, elapsed_s(utc_ns));
  if (fault != BatteryFault::kFrozen) refresh(utc_ns);
  return fault;
}

Bytes FaultyDevice::answer(const BusRequest& request, BatteryFault fault, std::int64_t utc_ns) {
  if (fault == BatteryFault::kLate) {
    refresh(utc_ns);
  } else {
    change_values(fault, utc_ns);
  }
  const Bytes right = right_answer(request, fault == BatteryFault::kAckWithoutEffect);
  return reply_.spoil(request, right, fault, plan_.random());
}

void FaultyDevice::advance(std::int64_t utc_ns) {
  live_until(utc_ns);
  const auto plant = hold_plant();
  battery_.advance(utc_ns);
}

std::unique_lock<std::mutex> FaultyDevice::hold_plant() const {
  return house_ == nullptr ? std::unique_lock<std::mutex>() : std::unique_lock(house_->plant);
}

void FaultyDevice::refresh(std::int64_t utc_ns) {
  const auto plant = hold_plant();
  image_.refresh(utc_ns);
}

/// Share of the ordered power that flows.
double FaultyDevice::gain(std::int64_t utc_ns) const {
  constexpr std::pair<BatteryFault, double> kGains[] = {{BatteryFault::kPartPower, 0.3},
                                                        {BatteryFault::kExcessPower, 2.0},
                                                        {BatteryFault::kInverted, -1.0},
                                                        {BatteryFault::kEcho, 0.0},
                                                        {BatteryFault::kHalfFlow, 0.5}};
  for (const auto& [fault, gain] : kGains) {
    if (plan_.lasts(fault, elapsed_s(utc_ns))) return gain;
  }
  return 1;
}

void FaultyDevice::show_grid_as_of(std::int64_t utc_ns) {
  const auto lasts = [&](BatteryFault fault) { return plan_.lasts(fault, elapsed_s(utc_ns)); };
  image_.set_grid_display({.gain = lasts(BatteryFault::kGridScaled)  ? 0.1
                                   : lasts(BatteryFault::kGridRatio) ? 0.65
                                                                     : 1.0,
                           .offset_w = lasts(BatteryFault::kGridOffset) ? -1'000.0 : 0.0,
                           .late_s = lasts(BatteryFault::kGridLate) ? 60 : 0,
                           .other_phase = lasts(BatteryFault::kGridOtherPhase)});
}

/// Actions of another master between two requests happen at their own time; other lasting faults
/// begin with the next request.
void FaultyDevice::live_until(std::int64_t utc_ns) {
  show_grid_as_of(utc_ns);
  if (map_.is_meter) return;
  const auto plant = hold_plant();
  const std::int64_t period_ns = plan_.period_s() * kNanosecondsPerSecond;
  for (; period_ns > 0 && next_action_ns_ <= utc_ns; next_action_ns_ += period_ns) {
    apply_lasting_faults(next_action_ns_);
    act_on_order(next_action_ns_);
  }
  apply_lasting_faults(utc_ns);
}

void FaultyDevice::apply_lasting_faults(std::int64_t utc_ns) {
  const auto lasts = [&](BatteryFault fault) { return plan_.lasts(fault, elapsed_s(utc_ns)); };
  const double rated_w = battery_.parameters().power_w_max;
  battery_.advance(utc_ns);
  battery_.set_habits({.gain = gain(utc_ns),
                       .idle_power_w = lasts(BatteryFault::kIdleDischarge) ? -0.75 * rated_w : 0.0,
                       .delay_s = lasts(BatteryFault::kSlowAndNoisy) ? 5.0 : 0.0,
                       .noise_frac = lasts(BatteryFault::kSlowAndNoisy) ? 0.02 : 0.0,
                       .slows_near_limits = lasts(BatteryFault::kThrottle),
                       .ramp_w_per_s = lasts(BatteryFault::kSlowRamp) ? 30.0 : 0.0,
                       .hidden_drain_w = lasts(BatteryFault::kHiddenDrain) ? 0.25 * rated_w : 0.0,
                       .forced_charge_w = lasts(BatteryFault::kForcedCharge) ? rated_w / 8 : 0.0,
                       .balancing_w = lasts(BatteryFault::kBalancing) ? 450.0 : 0.0});
  image_.set_display(
      {.soc_stands_still = lasts(BatteryFault::kSocStuck),
       .soc_is_inverted = lasts(BatteryFault::kSocInverted),
       .soc_offset_frac = lasts(BatteryFault::kSocRecalibrates) ? 0.06 : 0.0,
       .capacity_factor = lasts(BatteryFault::kOtherCapacity) ? 5.0 : 1.0,
       .order_as_power = lasts(BatteryFault::kEcho) || lasts(BatteryFault::kHalfFlow),
       .alarm = lasts(BatteryFault::kAlarm),
       .off_grid = lasts(BatteryFault::kOffGrid),
       .is_hot = lasts(BatteryFault::kHot)});
}

void FaultyDevice::act_on_order(std::int64_t utc_ns) {
  const auto lasts = [&](BatteryFault fault) { return plan_.lasts(fault, elapsed_s(utc_ns)); };
  image_.refresh(utc_ns);
  if (lasts(BatteryFault::kOtherMaster)) {
    image_.order_from_outside(-static_cast<std::int32_t>(battery_.parameters().power_w_max));
  }
  if (lasts(BatteryFault::kMasterStops)) image_.release_from_outside();
  if (lasts(BatteryFault::kMasterMode)) image_.change_mode_from_outside();
  if (lasts(BatteryFault::kEndsOrders)) {
    battery_.stop_dispatch();
    image_.refresh(utc_ns);
  }
}

/// Answer of a healthy battery, and the effect of a write.
Bytes FaultyDevice::right_answer(const BusRequest& request, bool keep_registers) {
  std::vector<std::uint16_t> before;
  if (keep_registers) before = registers_;
  Bytes bytes = reply_.answer(request, mapping_);
  if (keep_registers) {
    std::copy(before.begin(), before.end(), registers_.begin());  // image_ has a view of them
  } else if (request.is_write() &&
             request.address() + request.write_count() <= mapping_.nb_registers) {
    const auto plant = hold_plant();
    image_.apply_write(request.address(), request.write_count());
  }
  return bytes;
}

void FaultyDevice::change_values(BatteryFault fault, std::int64_t utc_ns) {
  const auto change = [this](const char* name, auto&& changed) {
    const int index = find_point(map_, name);
    if (index < 0) return;
    const RegisterPoint& point = map_.points[index];
    std::int64_t value = 0;
    RegisterBlock block;
    const int address = image_.address_of(index);
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
    image_.refresh(utc_ns);
  }
}

}  // namespace bess
