// Healthy batteries: the habits of the batteries of the trial, and the variants that supervision
// must accept. Nothing here is a fault.
#pragma once

#include <cstdint>
#include <ostream>
#include <span>

#include "edge/core/base/response_band.h"

namespace bess::trial {

/// Time of the recalibration by the battery's management, at most once a day.
enum class Calibration : std::uint8_t { kNone, kAtRest, kAtEnds };

struct BatteryNature {
  double rated_w = 4'000;
  double capacity_wh = 8'000;        ///< of the cells
  double shown_capacity_wh = 8'000;  ///< in its register
  double round_trip_frac = 0.92;
  double standby_w = 25;  ///< drain of the cells, always, in no power that is shown

  double lag_s = 5;  ///< from an order to the first change of power
  double ramp_w_per_s = 800;
  double noise_frac = 0.02;  ///< relative, standard deviation, changing within seconds
  double meter_gain = 1;     ///< shown power by true power
  double meter_offset_w = 0;

  double taper_from_frac = 0.92;  ///< charging power falls from here to full
  double taper_below_frac = 0.12;
  double derating_frac = 1;  ///< of the rating, from noon to 15:00 UTC
  bool shows_derating = false;
  bool is_cold = false;  ///< 2 to 12 degC; a fifth of the charging power below 8

  std::int32_t soc_step_e4 = 10;  ///< resolution of its display
  bool soc_flickers = false;      ///< between two steps of its display
  double settles_frac = 0;        ///< fall of its count in the half hour after a charge
  double counted_frac = 1;        ///< share of the energy that its management counts
  Calibration calibration = Calibration::kNone;
  double calibration_min_frac = 0;  ///< error of its count after a recalibration
  double calibration_max_frac = 0;

  std::int32_t refresh_s = 0;      ///< update period of its registers; 0 = always
  std::int32_t soc_refresh_s = 0;  ///< and its SoC
  double restarts_per_day = 0;
  double restart_s = 0;        ///< not reachable, then without any order
  double late_per_answer = 0;  ///< share of its answers that come late
  double late_s = 0;

  double forced_charge_below_frac = 0;  ///< 0 = never: it charges itself, whatever is ordered
  double forced_charge_until_frac = 0;
  double forced_charge_w = 500;
  double balancing_w = 0;      ///< balancing power when full, ten minutes of every twenty
  double pv_peak_w = 0;        ///< of the sun on its own direct current side
  bool follows_house = false;  ///< its own mode covers a house, and takes the rest of the sun
};

struct HonestVariant {
  const char* name;
  BatteryNature nature;
  bool charges_by_itself = false;    ///< its register map says so
  std::int32_t map_soc_step_e4 = 0;  ///< resolution by its register map; 0 = the truth
  std::int32_t night_charge_power_w = 4'000;
  std::int32_t map_settle_s = 20;  ///< lag by its register map
  std::int32_t map_soc_refresh_s = 60;
  friend void PrintTo(const HonestVariant& v, std::ostream* out) { *out << v.name; }
};

std::span<const HonestVariant> honest_variants();

}  // namespace bess::trial
