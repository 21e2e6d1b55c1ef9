// Plan of a day on its day-ahead prices, in integers: bit-identical on workstation and edge. Its
// result is the break-even price: the newest price at which the plan values charging and
// discharging equally at an instant and SoC.
//
//   ahead[b][i] = discount * sum over b' of P(b' | b, phase) value[b'][i]
//   value[b][i] = max over actions of  ahead[b](SoC after it from point i) - cost of the exchange
//
// by backward induction from the end of tomorrow, with stored energy at the usual price, to the
// start of today. For a step and SoC, bins up to a cut charge rather than discharge; the cut
// minimises the loss, and the break-even price is between the adjacent bins. It never rises with
// SoC, so that a policy that is monotone in the break-even price is also monotone in SoC.
#pragma once

#include <cstdint>

#include "shared/fixed_point.h"
#include "shared/outlook/outlook_model.h"

namespace bess {

inline constexpr int kLongestDayQuarterHours = 100;
inline constexpr int kLongestDaySteps =
    kLongestDayQuarterHours * kMinutesPerQuarterHour / kMinutesPerStep;
inline constexpr std::int32_t kDayAheadUnknown = INT32_MIN;
/// Distance of the levels of plans; linear in between.
inline constexpr std::int32_t kPlannedLevelCenti = 1600;

constexpr std::int32_t planned_level_centi(std::int32_t level_centi) {
  return rounding_divide(level_centi, kPlannedLevelCenti) * kPlannedLevelCenti;
}

/// Three local days around now, with known day-ahead prices.
struct OutlookDays {
  std::int64_t yesterday_utc_s = 0;  ///< local midnights
  std::int64_t today_utc_s = 0;
  std::int64_t tomorrow_utc_s = 0;
  std::int64_t end_utc_s = 0;
  /// By quarter-hour from `yesterday_utc_s` on, hundredths of EUR/MWh or kDayAheadUnknown.
  std::int32_t day_ahead_centi[3 * kLongestDayQuarterHours] = {};

  [[nodiscard]] int index_of(std::int64_t utc_s) const {
    return static_cast<int>((utc_s - yesterday_utc_s) / kSecondsPerQuarterHour);
  }
  friend bool operator==(const OutlookDays&, const OutlookDays&) = default;
};

/// Midnights around an instant, without prices. Needs the market's time zone.
OutlookDays outlook_days_around(std::int64_t utc_s);

/// Break-even prices of one step over the SoC grid, tenths of EUR/MWh, not ascending.
struct BreakEvenRow {
  std::int16_t tenths[OutlookModel::kSocPoints] = {};

  /// Hundredths of EUR/MWh, for a plan made at `planned_level_centi`.
  [[nodiscard]] std::int32_t at(const OutlookModel& model, std::int32_t soc_e4,
                                std::int32_t level_centi, std::int32_t planned_level_centi) const;
};

class OutlookPlan {
 public:
  /// For a level of planned_level_centi(). Bounded: at most 1,500 steps, no allocation.
  void make(const OutlookModel& model, const OutlookDays& days, std::int32_t level_centi);

  [[nodiscard]] bool serves(std::int64_t utc_s) const {
    return utc_s >= today_utc_s_ && utc_s < tomorrow_utc_s_;
  }
  /// Hundredths of EUR/MWh. Precondition: the plan serves the instant. Never rises with SoC.
  [[nodiscard]] std::int32_t break_even_centi(const OutlookModel& model, std::int64_t utc_s,
                                              std::int32_t soc_e4, std::int32_t level_centi) const {
    return row_at(utc_s).at(model, soc_e4, level_centi, level_centi_);
  }
  /// Precondition: the plan serves the instant.
  [[nodiscard]] const BreakEvenRow& row_at(std::int64_t utc_s) const {
    return break_even_[(utc_s - today_utc_s_) / kSecondsPerStep];
  }

 private:
  static constexpr int kBins = OutlookModel::kBins;
  static constexpr int kPoints = OutlookModel::kSocPoints;
  static constexpr int kQuarterHoursMax = 2 * kLongestDayQuarterHours;

  /// Result of a full step from a grid point; limited near the ends.
  struct Move {
    std::int32_t to;          ///< lower neighbour
    std::int32_t weight_q15;  ///< of the upper one
    std::int32_t share_q15;   ///< of the full step
  };
  void find_usual(const OutlookModel& model, const OutlookDays& days);
  void find_moves(const OutlookModel& model);
  void step_back(const OutlookModel& model, std::int64_t utc_s);
  void find_break_even(const OutlookModel& model, std::int64_t utc_s);
  [[nodiscard]] std::int32_t usual_centi(std::int64_t utc_s) const;

  std::int64_t today_utc_s_ = 0, tomorrow_utc_s_ = 0, end_utc_s_ = 0;
  std::int32_t level_centi_ = 0;
  BreakEvenRow break_even_[kLongestDaySteps] = {};
  // Work space of make().
  std::int32_t usual_[kQuarterHoursMax] = {};
  Move charge_[kPoints] = {}, discharge_[kPoints] = {};
  std::int32_t value_[kBins][kPoints] = {};  ///< hundredths of a cent per MWh of capacity
  std::int32_t lead_[kBins][kPoints] = {};   ///< value of charging minus discharging
};

// Checksum of plans: written to the header by the exporter, checked at every start of the edge.

/// Synthetic day-ahead prices: high in the morning and evening, low at noon, with a gap and an
/// unknown evening of tomorrow.
OutlookDays made_up_outlook_days(std::int64_t utc_s);

/// Checksum of the break-even prices of the day on which summer time began in 2025, at five SoCs.
/// `plan` is overwritten. Needs the market's time zone.
std::uint32_t outlook_check(const OutlookModel& model, OutlookPlan& plan);

}  // namespace bess
