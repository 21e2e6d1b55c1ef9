// Registers of a battery as its master sees them, for any register map. Measurements are computed
// from the physics at every request; writes become orders as the map defines (active, order_power,
// watchdog, [simulator]). Addresses, types and signs come from the same file that the edge uses;
// SunSpec models are a chain at the first base.
#pragma once

#include <cstdint>
#include <deque>
#include <span>
#include <utility>

#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"
#include "tools/simulators/battery_sim/house_load.h"
#include "tools/simulators/battery_sim/simulated_battery.h"

namespace bess {

class RegisterImage {
 public:
  static constexpr int kRegisterCount = 0x1'0000;

  /// One past the last address of this map, including SunSpec models.
  static int address_end(const RegisterMap& map);

  /// Registers of the bus, at least `address_end` of each kind. Both may be the same memory if the
  /// map has distinct addresses for the two kinds (not in sungrow_sh).
  RegisterImage(const RegisterMap& map, SimulatedBattery& battery, std::span<std::uint16_t> holding,
                std::span<std::uint16_t> input);

  /// Advances the battery to `utc_ns` and updates the measurements.
  void refresh(std::int64_t utc_ns);
  /// Applies a write to holding registers; call `refresh` before the write.
  void apply_write(int address, int count);

  // Commands of another master that uses this map: registers are written and applied.
  void order_from_outside(std::int32_t power_w);
  void release_from_outside();
  /// Changes the last condition of an order in force.
  void change_mode_from_outside();

  /// Differences between displayed and real values.
  struct Display {
    bool soc_stands_still = false;
    bool soc_is_inverted = false;  ///< mirrored at its value at the begin
    double soc_offset_frac = 0;
    double capacity_factor = 1;
    bool order_as_power = false;  ///< shows the order instead of the flow
    bool alarm = false;           ///< the first of the map
    bool off_grid = false;
    bool is_hot = false;
  };
  void set_display(const Display& display);
  /// Display of the power at the connection in the grid point.
  struct GridDisplay {
    double gain = 1;
    double offset_w = 0;
    std::int32_t late_s = 0;
    bool other_phase = false;  ///< a third of the house load, without the battery
  };
  void set_grid_display(const GridDisplay& display) { grid_display_ = display; }
  /// The grid point of the map then shows this house and the battery.
  void connect_house(const HouseLoad& house) { house_ = &house; }

  /// Address of a point in this image.
  [[nodiscard]] int address_of(int point) const;

 private:
  using Assignment = SimulatorHints::Assignment;

  void lay_out_models();
  void find_arguments();
  void identify(const IdentityCheck& check);
  [[nodiscard]] PointValues snapshot() const;
  [[nodiscard]] std::int64_t value(int point) const;
  void set(int point, std::int64_t value);
  void set(std::string_view name, double value);
  void show_soc();
  /// Value of a state before a fault, for the time after it.
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
  void start(const PointValues& registers);

  const RegisterMap& map_;
  SimulatedBattery& battery_;
  const HouseLoad* house_ = nullptr;
  GridDisplay grid_display_;
  std::deque<std::pair<std::int64_t, double>> grid_w_;  ///< last minutes, by second
  std::span<std::uint16_t> holding_, input_;
  const StaticVector<Condition, 4>& active_;
  const StaticVector<PowerCase, 4>& order_power_;
  int model_start_[decltype(RegisterMap::models)::capacity()] = {};
  int timer_ = -1;  ///< point of the duration of an order; -1: fixed by the device
  bool timer_counts_minutes_ = false;
  int soc_limit_ = -1, soc_min_ = -1, soc_max_ = -1;
  Display display_{};
  StateBefore before_alarm_, before_off_grid_;
  double mirror_soc_frac_ = 0;
  bool is_running_ = false;  ///< an order, at the last refresh or write
  std::int64_t utc_s_ = 0;
  std::int64_t end_utc_s_ = 0;  ///< of the order in force
};

}  // namespace bess
