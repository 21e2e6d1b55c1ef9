// SoC monitor: state of charge against measured power, reading by reading.
//
//   constant while power flows; does not match it over a longer span        contradiction
//   changes suddenly by more than power explains                            jump: recalibrated
//   shows another share of the energy, or loses some at rest                warning
//                                                                           (energy_balance.h)
// Near the ends the SoC may stick and be recalibrated: charging above 95 % and discharging below
// 10 % explain a constant SoC or a larger change than power. Only these: discharging at 97 %, it
// must fall. And only for as much energy as a correct SoC can be wrong by.
#pragma once

#include <cstdint>

#include "edge/core/supervision/energy_balance.h"
#include "edge/core/supervision/leaky_count.h"
#include "edge/core/supervision/response.h"

namespace bess {

class SocMonitor {
 public:
  explicit SocMonitor(const ResponseSettings& settings);

  void observe(const Response& now);
  /// Between two judged readings, just before an order changes: adds the energy.
  void note_cut(const Response& now);

  /// The SoC does not match this battery's energy.
  [[nodiscard]] bool contradicts() const { return contradicts_; }
  /// It changed by more than power explains, and readings have not yet agreed again.
  [[nodiscard]] bool has_jumped() const { return unsettled_readings_ > 0; }
  [[nodiscard]] const EnergyBalance::Findings& balance() const { return balance_.findings(); }

 private:
  /// Possible SoC change due to the power of an interval, in 1e-4 of the capacity.
  struct Flow {
    std::int64_t energy_e4 = 0;       ///< each reading's power since its order
    std::int64_t late_energy_e4 = 0;  ///< with the largest delay of power and SoC
    std::int64_t least_e4 = 0;        ///< SoC change within losses and capacity error
    std::int64_t most_e4 = 0;
  };

  [[nodiscard]] Flow flow_until(const Response& now) const;
  [[nodiscard]] std::int64_t measured_energy_ws(const Response& now, std::int64_t delay_s) const;
  [[nodiscard]] std::int64_t late_ws(const Response& now) const;
  [[nodiscard]] EnergyInterval interval_of(const Response& now, const Flow& flow) const;
  [[nodiscard]] std::int64_t e4_of(std::int64_t energy_ws) const;
  [[nodiscard]] bool rests(const Response& reading) const;
  [[nodiscard]] std::int32_t soc_step_e4() const;
  [[nodiscard]] std::int32_t soc_span_e4() const;
  [[nodiscard]] std::int64_t surely_moved_e4(const Flow& flow, std::int64_t seconds) const;
  bool is_excused(const Response& now, const Flow& flow, std::int64_t change_e4);
  bool is_beyond_its_end(std::int32_t soc_e4, const Flow& flow, std::int64_t change_e4);
  bool judge_jump(const Response& now, const Flow& flow, std::int64_t change_e4);
  [[nodiscard]] std::int64_t must_show_e4() const;
  void note_power(const Response& now);
  void judge_balance(const EnergyInterval& interval);
  void check_sparse_soc(const Response& now, bool excused);
  void judge_standstill(const Response& now, const Flow& flow, bool excused);
  void reset_from(const Response& now);

  ResponseSettings settings_;
  EnergyBalance balance_;
  SparseSocCheck sparse_soc_;  ///< instead of every reading, for a sparse SoC
  bool contradicts_ = false;

  bool has_before_ = false;
  Response before_;
  std::int64_t capacity_wh_ = 1;
  std::int64_t measured_energy_ws_ = 0;  ///< from `before_` until `flow_s_`
  std::int64_t late_ws_ = 0;             ///< the same, as late as permitted
  std::int64_t flow_s_ = 0;
  std::int32_t flow_power_w_ = 0;  ///< at `flow_s_`

  std::int32_t shown_step_e4_ = 0;  ///< greatest common divisor of the SoC values; 0 = none yet
  std::int32_t unsettled_readings_ = 0;
  LeakyCount jumps_;                ///< under power; at rest a recalibration is possible
  std::int64_t excused_e4_ = 0;     ///< at this end, since it was reached
  std::int64_t beyond_end_e4_ = 0;  ///< remainder beyond an end after a jump onto it
  /// Energy since the SoC last changed: now, and its extremes.
  std::int64_t still_e4_ = 0;
  std::int64_t still_least_e4_ = 0;
  std::int64_t still_most_e4_ = 0;
  std::int64_t still_total_e4_ = 0;  ///< absolute sum
  std::int32_t still_readings_ = 0;
};

}  // namespace bess
