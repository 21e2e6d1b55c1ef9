// What a healthy battery is like: the habits of the batteries of the trial, and the variants of
// them that supervision must leave alone. Nothing here is a fault.
#pragma once

#include <cstdint>
#include <ostream>
#include <span>

#include "edge/core/base/response_band.h"

namespace bess::trial {

/// When the battery's management sets its count of the charge right, at most once a day.
enum class Calibration : std::uint8_t { kNone, kAtRest, kAtEnds };

struct BatteryNature {
  double rated_w = 4'000;
  double capacity_wh = 8'000;        ///< of the cells
  double shown_capacity_wh = 8'000;  ///< in its register
  double round_trip_frac = 0.92;
  double standby_w = 25;  ///< out of the cells, always, in no power that is shown

  double lag_s = 5;  ///< from an order to the first change of power
  double ramp_w_per_s = 800;
  double noise_frac = 0.02;  ///< of the power, standard deviation, wandering within seconds
  double meter_gain = 1;     ///< shown power by true power
  double meter_offset_w = 0;

  double taper_from_frac = 0.92;  ///< charging power falls from here to full
  double taper_below_frac = 0.12;
  double derating_frac = 1;  ///< of the rating, from noon to 15:00 UTC
  bool shows_derating = false;
  bool is_cold = false;  ///< 2 to 12 degC; a fifth of the charging power below 8

  std::int32_t soc_step_e4 = 10;  ///< of its display
  bool soc_flickers = false;      ///< between two steps of its display
  double settles_frac = 0;        ///< its count falls by so much in the half hour after a charge
  double counted_frac = 1;        ///< of what flows its management counts so much
  Calibration calibration = Calibration::kNone;
  double calibration_min_frac = 0;  ///< how far its count is off when it is set right
  double calibration_max_frac = 0;

  std::int32_t refresh_s = 0;      ///< its registers are brought up to date so seldom; 0 = always
  std::int32_t soc_refresh_s = 0;  ///< and its SoC
  double restarts_per_day = 0;
  double restart_s = 0;        ///< not reachable, then without any order
  double late_per_answer = 0;  ///< share of its answers that come late
  double late_s = 0;

  double forced_charge_below_frac = 0;  ///< 0 = never: it charges itself, whatever is ordered
  double forced_charge_until_frac = 0;
  double forced_charge_w = 500;
  double balancing_w = 0;      ///< into its resistors when it is full, ten minutes of every twenty
  double pv_peak_w = 0;        ///< of the sun on its own direct current side
  bool follows_house = false;  ///< its own mode covers a house, and takes what the sun has left
};

struct HonestVariant {
  const char* name;
  BatteryNature nature;
  bool charges_by_itself = false;     ///< its register map says so
  std::int32_t told_soc_step_e4 = 0;  ///< what its register map says of its display; 0 = the truth
  std::int32_t night_charge_power_w = 4'000;
  std::int32_t told_settle_s = 20;  ///< what it says of its lag
  std::int32_t told_soc_refresh_s = 60;
  friend void PrintTo(const HonestVariant& v, std::ostream* out) { *out << v.name; }
};

std::span<const HonestVariant> honest_variants();

}  // namespace bess::trial
