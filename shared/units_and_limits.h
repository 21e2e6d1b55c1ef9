// Physical constants and limits of the whole chain, with asserts on their relations. Battery and
// market are configuration (battery_model.h).
// Sign convention everywhere: power and energy are positive when the battery CHARGES, grid side.
#pragma once

#include <cstdint>

namespace bess {

// --- Time grid [SPEC 2, 3] -------------------------------------------------------------------
inline constexpr int kMinutesPerStep = 2;  ///< one decision every 2 minutes
inline constexpr int kSecondsPerStep = 60 * kMinutesPerStep;
inline constexpr int kMinutesPerQuarterHour = 15;
inline constexpr int kSecondsPerQuarterHour = 60 * kMinutesPerQuarterHour;
inline constexpr std::int64_t kSecondsPerDay = 86'400;  ///< without a clock change
inline constexpr int kMinutesPerDay = 24 * 60;
inline constexpr int kStepsPerDay = kMinutesPerDay / kMinutesPerStep;
inline constexpr double kHoursPerStep = kMinutesPerStep / 60.0;
static_assert(kStepsPerDay == 720);

// --- Lattice of all inputs of the student [SPEC 6] ---------------------------------------------
inline constexpr int kMinuteOfQuarterHourCount = kMinutesPerQuarterHour;           ///< T_qh 0..14
inline constexpr int kQuarterHourCount = kMinutesPerDay / kMinutesPerQuarterHour;  ///< qh 0..95
inline constexpr int kContextClassCount = 12;                                      ///< mo 1..12
inline constexpr int kSocCount = 201;  ///< SoC k * 0.5 %
inline constexpr int kLatticePriceMinEurPerMwh = -500;
inline constexpr int kLatticePriceMaxEurPerMwh = 1500;
inline constexpr int kPriceCount = kLatticePriceMaxEurPerMwh - kLatticePriceMinEurPerMwh + 1;
inline constexpr int kContextCount =
    kMinuteOfQuarterHourCount * kQuarterHourCount * kContextClassCount;
inline constexpr std::int64_t kLatticeStateCount =
    std::int64_t{kContextCount} * kSocCount * kPriceCount;
static_assert(kPriceCount == 2001 && kLatticeStateCount == 6'950'033'280);

inline constexpr double kWattsPerMegawatt = 1e6;  ///< prices are per MWh, powers are in W

// --- Prices on the edge: integer hundredths of EUR/MWh [SPEC 7] --------------------------------
inline constexpr std::int32_t kCentiPerEur = 100;
/// Prices outside +-100,000 EUR/MWh are refused as implausible: no bid of a European balancing
/// market may pass +-99,999, and one of them settled at 25,907.54 in January 2026.
inline constexpr std::int32_t kPlausiblePriceMaxEurPerMwh = 100'000;
inline constexpr std::int32_t kPlausiblePriceMaxCentiEurPerMwh =
    kPlausiblePriceMaxEurPerMwh * kCentiPerEur;
/// Prices outside +-15,000 EUR/MWh are reported.
inline constexpr std::int32_t kUnusualPriceMaxEurPerMwh = 15'000;

// --- SoC on the edge: integer hundredths of a percent ------------------------------------------
inline constexpr std::int32_t kSocFullE4 = 10'000;  ///< 100 %
inline constexpr std::int32_t kSocE4PerLatticeStep = kSocFullE4 / (kSocCount - 1);
static_assert(kSocE4PerLatticeStep * (kSocCount - 1) == kSocFullE4);

}  // namespace bess
