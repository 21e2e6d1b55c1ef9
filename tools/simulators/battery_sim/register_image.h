// The registers of a battery as its master sees them, for any register map: measurements are
// rendered from the physics at every request, and writes become orders by what the map itself says
// about them (active, order_power, watchdog, [simulator]). Addresses, types and signs come from the
// same file that the edge uses; SunSpec models are laid out as a chain at the first base.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <utility>

#include "edge/device/registers/live_points.h"
#include "edge/device/registers/register_map.h"
#include "tools/simulators/battery_sim/house_load.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

class RegisterImage {
 public:
  static constexpr int kRegisterCount = 0x1'0000;

  /// One past the last address that this map uses, its SunSpec models laid out.
  static int address_end(const RegisterMap& map);

  /// The registers that the bus serves, at least `address_end` of each kind; both may be the same
  /// memory when the map gives the two kinds addresses of their own, which sungrow_sh does not.
  RegisterImage(const RegisterMap& map, SimulatedBattery& battery, std::span<std::uint16_t> holding,
                std::span<std::uint16_t> input);

  /// Brings the battery to `utc_ns` and renders what it measures.
  void refresh(std::int64_t utc_ns);
  /// Acts on a write that has just changed holding registers; call `refresh` before the write.
  void apply_write(int address, int count);

  // What another master does who knows this map: registers are written as by a command of it, and
  // acted on.
  void order_from_outside(std::int32_t power_w);
  void release_from_outside();
  /// Of what shows that an order is in force, the last: another value than its order's.
  void change_mode_from_outside();

  /// Values that are shown otherwise than they are.
  struct Display {
    bool soc_stands_still = false;
    bool soc_is_inverted = false;  ///< mirrored at where it was when this began
    double soc_offset_frac = 0;
    double capacity_factor = 1;
    bool order_as_power = false;  ///< what was ordered, not what flows
    bool alarm = false;           ///< the map's first
    bool off_grid = false;
    bool is_hot = false;
  };
  void set_display(const Display& display);
  /// How the grid point shows the power at the connection.
  struct GridDisplay {
    double gain = 1;
    double offset_w = 0;
    std::int32_t late_s = 0;
    bool other_phase = false;  ///< a third of the house, and not the battery
  };
  void set_grid_display(const GridDisplay& display) { grid_display_ = display; }
  /// From now on the map's grid point shows this house and the battery.
  void connect_house(const HouseLoad& house) { house_ = &house; }

  /// Where a point lies in this image.
  [[nodiscard]] int address_of(int point) const;

 private:
  using Assignment = SimulatorHints::Assignment;

  void lay_out_models();
  void find_arguments();
  void identify(const IdentityCheck& check);
  [[nodiscard]] LivePoints snapshot() const;
  [[nodiscard]] std::int64_t value(int point) const;
  void set(int point, std::int64_t value);
  void set(std::string_view name, double value);
  void show_soc();
  /// A state as long as it lasts; afterwards what stood there before.
  struct StateBefore {
    bool is_kept = false;
    std::int64_t value = 0;
  };
  void show_state(const Condition& state, bool lasts, StateBefore& before);
  [[nodiscard]] double shown_grid_w();
  void show_power(const StaticVector<PowerCase, 4>& all, std::int64_t power_w);
  void assign(const Assignment& assignment);
  [[nodiscard]] bool covers(int address, int count, int point) const;
  [[nodiscard]] bool is_order_ignored(int address, int count) const;
  void write_from_outside(Command command, std::int32_t power_w);
  [[nodiscard]] std::int64_t duration_s() const;
  [[nodiscard]] double soc_limit_frac(std::int64_t power_w) const;
  void start(const LivePoints& registers);
  void show_expiry();

  const RegisterMap& map_;
  SimulatedBattery& battery_;
  const HouseLoad* house_ = nullptr;
  GridDisplay grid_display_;
  std::deque<std::pair<std::int64_t, double>> grid_w_;  ///< of the last minutes, by second
  std::span<std::uint16_t> holding_, input_;
  const StaticVector<Condition, 4>& active_;
  const StaticVector<PowerCase, 4>& order_power_;
  int model_start_[decltype(RegisterMap::models)::capacity()] = {};
  int timer_ = -1;  ///< point that an order's duration is written to; -1 = fixed by the device
  bool timer_counts_minutes_ = false;
  int soc_limit_ = -1, soc_min_ = -1, soc_max_ = -1;
  Display display_{};
  StateBefore before_alarm_, before_off_grid_;
  double mirror_soc_frac_ = 0;
  bool is_running_ = false;  ///< an order, at the last refresh or write
  std::int64_t utc_s_ = 0;
  std::int64_t end_utc_s_ = 0;  ///< of the order under way
};

}  // namespace bess
