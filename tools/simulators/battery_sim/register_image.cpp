#include "tools/simulators/battery_sim/register_image.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "edge/device/registers/codec.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr double kRoomTemperatureDeciC = 200;
constexpr double kHotDeciC = 700;
constexpr std::int64_t kForEverS = 100LL * 365 * kSecondsPerDay;
constexpr int kCommonModelRegisters = 66;

/// Length in the header of a model: registers after id and length.
int model_registers(const RegisterMap& map, int model) {
  int registers = 0;
  for (const RegisterPoint& p : map.points) {
    if (p.model == model) registers = std::max(registers, p.address + p.registers - 2);
  }
  return registers;
}

/// Address of the first model of the map: after "SunS" and the common model.
int first_model_address(const RegisterMap& map) {
  return map.model_bases[0] + 2 + 2 + kCommonModelRegisters;
}

}  // namespace

RegisterImage::RegisterImage(const RegisterMap& map, SimulatedBattery& battery,
                             std::span<std::uint16_t> holding, std::span<std::uint16_t> input)
    : map_(map),
      battery_(battery),
      holding_(holding),
      input_(input),
      active_(map.simulator.active.empty() ? map.active : map.simulator.active),
      order_power_(map.simulator.order_power.empty() ? map.order_power
                                                     : map.simulator.order_power) {
  const int end = address_end(map);
  if (end > kRegisterCount || std::ssize(holding) < end || std::ssize(input) < end) {
    fail("map {}: {} registers are not enough, it needs {}", map.name.view(), holding.size(), end);
  }
  lay_out_models();
  find_arguments();
  // Scale factors first: other values are encoded with them.
  for (const RegisterPoint& p : map_.points) {
    if (p.scale_from >= 0) set(p.scale_from, map_.points[p.scale_from].value_min);
  }
  for (const Assignment& assignment : map_.simulator.initial) assign(assignment);
  for (const IdentityCheck& check : map_.identity) identify(check);
}

/// Shows the value that the check expects. Measurements then overwrite it: the capacity may differ.
void RegisterImage::identify(const IdentityCheck& check) {
  const RegisterPoint& p = map_.points[check.point];
  if (p.type != RegisterType::kText) {
    const std::int64_t shown = value(check.point);
    if (shown < check.value_min || shown > check.value_max) set(check.point, check.value_min);
    return;
  }
  for (std::size_t i = 0; i < check.text.view().size(); ++i) {
    const auto character = static_cast<std::uint8_t>(check.text.view()[i]);
    holding_[address_of(check.point) + i / 2] |=
        static_cast<std::uint16_t>(i % 2 == 0 ? character << 8 : character);
  }
}

int RegisterImage::address_end(const RegisterMap& map) {
  int end = 0;
  for (const RegisterPoint& p : map.points) {
    if (p.model < 0) end = std::max(end, p.address + p.registers);
  }
  if (map.models.empty()) return end;
  int chain_end = first_model_address(map);
  for (int m = 0; m < map.models.size(); ++m) chain_end += 2 + model_registers(map, m);
  return std::max(end, chain_end + 2);
}

/// "SunS", the common model, the map's models in their order, the end mark.
void RegisterImage::lay_out_models() {
  if (map_.models.empty()) return;
  const int base = map_.model_bases[0];
  const std::uint16_t head[] = {0x5375, 0x6E53, 1, kCommonModelRegisters};
  std::copy(std::begin(head), std::end(head), holding_.begin() + base);
  int address = first_model_address(map_);
  for (int m = 0; m < map_.models.size(); ++m) {
    model_start_[m] = address;
    holding_[address] = map_.models[m];
    holding_[address + 1] = static_cast<std::uint16_t>(model_registers(map_, m));
    address += 2 + holding_[address + 1];
  }
  holding_[address] = 0xFFFF;
  holding_[address + 1] = 0;
}

/// Points for duration and limits of an order.
void RegisterImage::find_arguments() {
  for_each_written(map_, [this](const WriteValue& value) {
    if (value.argument == Argument::kDuration) timer_ = value.point;
    if (value.argument == Argument::kDurationMinutes) {
      timer_ = value.point;
      timer_counts_minutes_ = true;
    }
    if (value.argument == Argument::kSocLimit) soc_limit_ = value.point;
    if (value.argument == Argument::kSocMin) soc_min_ = value.point;
    if (value.argument == Argument::kSocMax) soc_max_ = value.point;
  });
}

/// The time between requests adds to the delay.
double RegisterImage::shown_grid_w() {
  constexpr std::int64_t kKeptS = 300;
  const double house_w = house_->power_w(utc_s_);
  grid_w_.emplace_back(utc_s_, house_w + battery_.power_w());
  while (grid_w_.front().first < utc_s_ - kKeptS) grid_w_.pop_front();
  if (grid_display_.other_phase) return house_w / 3;
  double grid_w = grid_w_.front().second;
  for (const auto& [second, power_w] : grid_w_) {
    if (second <= utc_s_ - grid_display_.late_s) grid_w = power_w;
  }
  return grid_display_.gain * grid_w + grid_display_.offset_w;
}

void RegisterImage::refresh(std::int64_t utc_ns) {
  battery_.advance(utc_ns);
  utc_s_ = utc_ns / kNanosecondsPerSecond;
  if (is_running_ && !battery_.dispatch_active()) {
    for (const Assignment& assignment : map_.simulator.at_expiry) assign(assignment);
  }
  is_running_ = battery_.dispatch_active();
  const BatteryParameters& p = battery_.parameters();
  show_soc();
  const double shown_w =
      display_.order_as_power ? battery_.commanded_power_w() : battery_.power_w();
  show_power(map_.measured_power, std::llround(shown_w));
  if (house_ != nullptr) {
    show_power(map_.grid_power, std::llround(shown_grid_w()));
  }
  set("capacity", p.capacity_wh * display_.capacity_factor);
  set("charge_power_max", p.power_w_max * battery_.derating());
  set("discharge_power_max", p.power_w_max * battery_.derating());
  set("temperature_min", kRoomTemperatureDeciC);
  set("temperature_max", display_.is_hot ? kHotDeciC : kRoomTemperatureDeciC);
  if (!map_.alarms.empty()) show_state(map_.alarms[0], display_.alarm, before_alarm_);
  show_state(map_.off_grid, display_.off_grid, before_off_grid_);
  if (map_.alive.point >= 0) {
    const RegisterPoint& alive = map_.points[map_.alive.point];
    set(map_.alive.point, alive.value_min + utc_s_ % (alive.value_max - alive.value_min + 1));
  }
  if (map_.watchdog.remaining >= 0) {
    set(map_.watchdog.remaining, is_running_ ? std::max<std::int64_t>(end_utc_s_ - utc_s_, 0) : 0);
  }
}

void RegisterImage::show_state(const Condition& state, bool lasts, StateBefore& before) {
  if (state.point < 0 || lasts == before.is_kept) return;
  const bool is_other = state.test == Condition::Test::kNotEqual;
  const std::int64_t shown = is_other ? state.value + 1 : state.value;
  if (lasts) before.value = value(state.point);
  set(state.point, lasts ? shown : before.value);
  before.is_kept = lasts;
}

void RegisterImage::set_display(const Display& display) {
  if (display.soc_is_inverted && !display_.soc_is_inverted) mirror_soc_frac_ = battery_.soc_frac();
  display_ = display;
}

void RegisterImage::show_soc() {
  if (display_.soc_stands_still) return;
  const double soc_frac = battery_.soc_frac();
  const double shown_frac = display_.soc_is_inverted ? 2 * mirror_soc_frac_ - soc_frac : soc_frac;
  set("soc", std::clamp(shown_frac + display_.soc_offset_frac, 0.0, 1.0) * 1e4);
}

/// One signed register (of several phases the first), one for each direction, or a magnitude whose
/// sign is in a state.
void RegisterImage::show_power(const StaticVector<PowerCase, 4>& all, std::int64_t power_w) {
  // Cases after an unconditional one are for devices without its points.
  const bool is_first_alone = !all.empty() && all[0].when.point < 0;
  const std::span cases(all.begin(), static_cast<std::size_t>(is_first_alone ? 1 : all.size()));
  for (const PowerCase& c : cases) {
    const bool has_sign =
        c.when.point < 0 && std::all_of(c.terms.begin(), c.terms.end(), [&](const auto& term) {
          return term.sign == c.terms[0].sign;
        });
    for (int i = 0; i < c.terms.size(); ++i) {
      const std::int64_t value = c.terms[i].sign * power_w;
      const std::int64_t of_phase = i == 0 ? value : 0;
      set(c.terms[i].point, has_sign ? of_phase : std::max<std::int64_t>(value, 0));
    }
  }
  for (const PowerCase& c : cases) {
    if (c.when.point >= 0) set(c.when.point, 0);
  }
  for (const PowerCase& c : cases) {
    if (c.when.point < 0 || c.terms.empty() || c.terms[0].sign * power_w <= 0) continue;
    set(c.terms[0].point, std::abs(power_w));
    set(c.when.point, c.when.value);
    return;
  }
}

void RegisterImage::apply_write(int address, int count) {
  if (map_.is_meter) return;  // keeps the written values, without effect
  const PointValues registers = snapshot();
  if (!active_.empty() && !live_all(map_, active_, registers)) {
    battery_.stop_dispatch();
    is_running_ = false;
    return;
  }
  if (is_running_ && is_order_ignored(address, count)) return;
  start(registers);
}

void RegisterImage::order_from_outside(std::int32_t power_w) {
  if (!is_running_) write_from_outside(Command::kEnable, power_w);
  write_from_outside(command_of(power_w), power_w);
}

void RegisterImage::release_from_outside() { write_from_outside(Command::kRelease, 0); }

void RegisterImage::write_from_outside(Command command, std::int32_t power_w) {
  const PowerOrder order{.power_w = power_w, .duration_s = map_.watchdog.duration_s};
  for (const BlockWrite& write : map_.sequence(command).writes) {
    RegisterBlock block;
    const PointValues live = snapshot();
    if (encode_block(map_, write, order, block, {.live = &live}) != Status::kOk) continue;
    const int address = address_of(write.values[0].point);
    std::copy(block.begin(), block.end(), holding_.begin() + address);
    apply_write(address, block.size());
  }
}

void RegisterImage::change_mode_from_outside() {
  if (active_.empty()) return;
  const Condition& mode = active_[active_.size() - 1];
  const RegisterPoint& p = map_.points[mode.point];
  const bool is_named = mode.test == Condition::Test::kEqual;
  std::int64_t other = (is_named ? mode.value : value(mode.point)) - 1;
  if (other < p.value_min || (!is_named && other == mode.value)) other += 2;
  set(mode.point, other);
  apply_write(address_of(mode.point), p.registers);
}

bool RegisterImage::is_order_ignored(int address, int count) const {
  const auto& apply_on = map_.simulator.apply_on;
  return !apply_on.empty() && std::none_of(apply_on.begin(), apply_on.end(), [&](std::int8_t p) {
    return covers(address, count, p);
  });
}

void RegisterImage::start(const PointValues& registers) {
  std::int64_t power_w = 0;
  if (!live_power(map_, order_power_, registers, power_w)) power_w = 0;
  const std::int64_t seconds = duration_s();
  battery_.start_dispatch(static_cast<double>(power_w), soc_limit_frac(power_w), seconds);
  end_utc_s_ = utc_s_ + seconds;
  is_running_ = battery_.dispatch_active();
}

std::int64_t RegisterImage::duration_s() const {
  using enum Watchdog::Kind;
  if (map_.watchdog.kind == kNone) return kForEverS;
  if (timer_ < 0) return map_.watchdog.duration_s;
  const std::int64_t written = value(timer_) * (timer_counts_minutes_ ? 60 : 1);
  return map_.watchdog.kind == kRevertTimer && written == 0 ? kForEverS : written;
}

double RegisterImage::soc_limit_frac(std::int64_t power_w) const {
  const int own = power_w < 0 ? soc_min_ : soc_max_;
  const int point = soc_limit_ >= 0 ? soc_limit_ : own;
  if (point < 0) return power_w < 0 ? 0.0 : 1.0;
  return static_cast<double>(value(point)) / 1e4;
}

int RegisterImage::address_of(int point) const {
  const RegisterPoint& p = map_.points[point];
  return p.address + (p.model < 0 ? 0 : model_start_[p.model]);
}

PointValues RegisterImage::snapshot() const {
  PointValues live;
  for (int i = 0; i < map_.points.size(); ++i) {
    const RegisterPoint& p = map_.points[i];
    live.keep(map_, i, &(p.read_function == 4 ? input_ : holding_)[address_of(i)]);
  }
  return live;
}

std::int64_t RegisterImage::value(int point) const {
  std::int64_t result = 0;
  return live_value(map_, snapshot(), point, result) ? result : 0;
}

void RegisterImage::set(std::string_view name, double value) {
  const int point = find_point(map_, name);
  if (point >= 0) set(point, std::llround(value));
}

void RegisterImage::set(int point, std::int64_t value) {
  const RegisterPoint& p = map_.points[point];
  Scaling scaling;
  RegisterBlock block;
  // A snapshot is needed only for points scaled by another point.
  const bool is_scaled = p.scale_from >= 0 || p.percent_of >= 0;
  if (is_scaled && !live_scaling(map_, snapshot(), point, scaling)) return;
  if (encode(p, value, Rounding::kNearest, block, scaling) != Status::kOk) return;
  const std::span<std::uint16_t> registers = p.read_function == 4 ? input_ : holding_;
  if (p.mask != 0 && p.registers == 1) {  // other points share this register
    const auto others = registers[address_of(point)] & ~p.mask;
    const auto own = static_cast<std::uint64_t>(value) << std::countr_zero(p.mask);
    registers[address_of(point)] = static_cast<std::uint16_t>(others | (own & p.mask));
    return;
  }
  for (int i = 0; i < block.size(); ++i) registers[address_of(point) + i] = block[i];
}

void RegisterImage::assign(const Assignment& assignment) {
  const BatteryParameters& p = battery_.parameters();
  switch (assignment.source) {
    case Assignment::Source::kConstant:
      return set(assignment.point, assignment.constant);
    case Assignment::Source::kPowerMax:
      return set(assignment.point, std::llround(p.power_w_max));
    case Assignment::Source::kCapacity:
      return set(assignment.point, std::llround(p.capacity_wh));
  }
}

bool RegisterImage::covers(int address, int count, int point) const {
  const int begin = address_of(point);
  return address <= begin && begin + map_.points[point].registers <= address + count;
}

}  // namespace bess
