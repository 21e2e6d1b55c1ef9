// Outlook model in integers: market and battery parameters of the plan on day-ahead prices. Fitted
// on the workstation (planners/outlook_integers.cpp), part of a student with context outlook.
//
//   usual(t, L) = constant + day_ahead D(t) + hour(quarter-hour of t) + level L
//
// Money is in hundredths of EUR/MWh, energy per MWh of capacity.
#pragma once

#include <cstdint>

#include "shared/crc32.h"
#include "shared/units_and_limits.h"

namespace bess {

struct OutlookModel {
  static constexpr int kBins = 24;    ///< of the deviation from the usual price
  static constexpr int kPhases = 15;  ///< steps of a half-hour
  static constexpr int kSocPoints = 61;
  static constexpr int kCoefficientBits = 12;
  static constexpr int kProbabilityBits = 15;
  static constexpr int kPointBits = 15;
  static constexpr int kEnergyBits = 24;

  std::int32_t constant_centi = 0;
  std::int32_t day_ahead_q12 = 0;
  std::int32_t level_q12 = 0;
  std::int32_t lasting_q12 =
      0;  ///< share of a day's deviation from the mean that persists to the next day
  std::int32_t row_age_min = 1;  ///< of the newest price at a decision
  std::int32_t hour_centi[kQuarterHourCount] = {};
  std::int32_t day_ahead_mean_centi[kQuarterHourCount] = {};
  std::int32_t bin_centi[kBins] = {};            ///< mean deviation of each bin, ascending
  std::int32_t paid_centi[kPhases][kBins] = {};  ///< mean deviation of the settled price
  /// [phase][bin][next bin], Q15; each row sums to one.
  std::int32_t transition_q15[kPhases][kBins][kBins] = {};
  std::int32_t discount_q15 = 0;  ///< of a step
  std::int32_t soc_min_e4 = 0, soc_max_e4 = 0;
  /// Step at full power: grid energy per MWh of capacity, Q24, and points of the SoC grid, Q15.
  std::int32_t charge_q24 = 0, discharge_q24 = 0;
  std::int32_t charge_points_q15 = 0, discharge_points_q15 = 0;
  /// Costs in addition to the price, with wear: fixed part, and share of the absolute price, Q12.
  std::int32_t import_centi = 0, export_centi = 0;
  std::int32_t import_share_q12 = 0, export_share_q12 = 0;

  /// Visits all numbers by name, for files, headers and hashes.
  template <typename Model, typename Visit>
  static constexpr void visit(Model& m, Visit visit) {
    visit("constant_centi", &m.constant_centi, 1);
    visit("day_ahead_q12", &m.day_ahead_q12, 1);
    visit("level_q12", &m.level_q12, 1);
    visit("lasting_q12", &m.lasting_q12, 1);
    visit("row_age_min", &m.row_age_min, 1);
    visit("hour_centi", m.hour_centi, kQuarterHourCount);
    visit("day_ahead_mean_centi", m.day_ahead_mean_centi, kQuarterHourCount);
    visit("bin_centi", m.bin_centi, kBins);
    visit("paid_centi", m.paid_centi[0], kPhases * kBins);
    visit("transition_q15", m.transition_q15[0][0], kPhases * kBins * kBins);
    visit("discount_q15", &m.discount_q15, 1);
    visit("soc_min_e4", &m.soc_min_e4, 1);
    visit("soc_max_e4", &m.soc_max_e4, 1);
    visit("charge_q24", &m.charge_q24, 1);
    visit("discharge_q24", &m.discharge_q24, 1);
    visit("charge_points_q15", &m.charge_points_q15, 1);
    visit("discharge_points_q15", &m.discharge_points_q15, 1);
    visit("import_centi", &m.import_centi, 1);
    visit("export_centi", &m.export_centi, 1);
    visit("import_share_q12", &m.import_share_q12, 1);
    visit("export_share_q12", &m.export_share_q12, 1);
  }

  /// False for numbers that no fit produces, which could overflow in the plan.
  [[nodiscard]] bool is_sound() const;
  /// Hash of all numbers in the order of visit(), independent of the byte order.
  [[nodiscard]] std::uint32_t hash() const;
};

/// Hash of student and model; without a model (0) that of the student.
constexpr std::uint32_t hash_by_outlook(std::uint32_t student_hash, std::uint32_t model_hash) {
  if (model_hash == 0) return student_hash;
  Crc32 crc;
  crc.add_integer(student_hash);
  crc.add_integer(model_hash);
  return crc.value();
}

}  // namespace bess
