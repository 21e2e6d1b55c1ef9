// Initial price level at program start, in this order of sources:
//   log          the newest record: the level does not change while the program is stopped
//   history      prices of the last days, from the server
//   setting      the operator's estimate
//   none         the first price sets it
// A student by month needs only the log.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>

#include "shared/context_classes.h"
#include "shared/fixed_point.h"
#include "shared/price_level.h"
#include "shared/units_and_limits.h"

namespace bess {

// Estimate of an imbalance price that is too old to trade on: its distance from the trailing level
// decays by 1/30 per step, to about a third after an hour. Measured on three years: for half an
// hour this saves up to two fifths of the cost of a short outage; after an hour no estimate is
// profitable (shared/manual/notebook/2026-11-26_stand_in_for_missing_prices.md).

/// Hundredths of EUR/MWh. `age_s` from 0 to a day.
constexpr std::int32_t stand_in_centi(std::int32_t newest_centi, std::int32_t level_centi,
                                      std::int64_t age_s) {
  constexpr std::int64_t kStepsToFade = 30;  ///< time constant of an hour
  std::int64_t distance_centi = std::int64_t{newest_centi} - level_centi;
  for (std::int64_t step = age_s / kSecondsPerStep; step > 0; --step) {
    distance_centi = rounding_divide(distance_centi * (kStepsToFade - 1), kStepsToFade);
  }
  return static_cast<std::int32_t>(level_centi + distance_centi);
}

enum class LevelSource : std::uint8_t { kLog, kHistory, kSetting, kNone };

struct LevelStart {
  PriceLevel level{};
  LevelSource source = LevelSource::kNone;
  bool refused_log = false;  ///< the logged level cannot result from prices
};

/// The level of the newest record, validated. A row from the future was logged under a wrong clock:
/// its level is kept, but present rows must count again.
constexpr PriceLevel level_from_log(const PriceLevel& logged, std::int64_t now_utc_s) {
  if (!logged.is_known() || !logged.is_sound()) return {};
  const std::int64_t newest_possible_utc_s = std::max<std::int64_t>(now_utc_s / 60 * 60 - 60, 1);
  return {.centi_q16 = logged.centi_q16,
          .row_minute_utc_s = std::min(logged.row_minute_utc_s, newest_possible_utc_s)};
}

/// `fetch_history` returns the level of the last days, unknown without rows; called only when
/// needed.
template <typename FetchHistory>
LevelStart find_start_level(ContextKind kind, const PriceLevel& logged, std::int64_t now_utc_s,
                            std::optional<std::int32_t> setting_centi_eur_per_mwh,
                            const FetchHistory& fetch_history) {
  const PriceLevel kept = level_from_log(logged, now_utc_s);
  if (kept.is_known()) return {.level = kept, .source = LevelSource::kLog};
  LevelStart start{.refused_log = !logged.is_sound()};
  if (kind == ContextKind::kMonth) return start;
  start.level = fetch_history();
  if (start.level.is_known()) {
    start.source = LevelSource::kHistory;
  } else if (setting_centi_eur_per_mwh.has_value()) {
    start.level = PriceLevel::starting_at(*setting_centi_eur_per_mwh);
    start.source = LevelSource::kSetting;
  }
  return start;
}

}  // namespace bess
