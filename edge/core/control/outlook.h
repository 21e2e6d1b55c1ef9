// Outlook input of the student: break-even price of the plan on day-ahead prices (shared/outlook)
// for this tick and SoC. bess-prices plans the rows of the next ticks; a control cycle takes what
// is available.
//   planned   plan for this tick, with the published price of its quarter-hour
//   usual     plan for this tick, with the usual price of this hour and level
//   late      plan for an earlier tick or another level: bess-prices is behind
//   missing   no row for this tick: the usual day, computed at start
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/core/base/status.h"
#include "shared/outlook/outlook_plan.h"

namespace bess {

/// Logged by value: new ones are appended.
enum class OutlookSource : std::uint8_t { kNone, kPlanned, kUsual, kLate, kMissing };
inline constexpr int kOutlookSourceCount = 5;

constexpr std::string_view outlook_source_name(OutlookSource source) {
  constexpr std::string_view kNames[] = {"none", "planned", "usual", "late", "missing"};
  return kNames[static_cast<int>(source)];
}

/// A quarter-hour and its published price.
struct PricedQuarterHour {
  std::int64_t utc_s = 0;  ///< its start; 0 = none
  std::int32_t centi_eur_per_mwh = 0;
};

/// The outlook's part of a cycle, for the log; empty for other contexts.
struct OutlookReport {
  OutlookSource source = OutlookSource::kNone;
  std::int32_t break_even_centi = 0;
  std::int16_t known_quarter_hours = 0;     ///< published, from the tick onwards
  PricedQuarterHour dearest{}, cheapest{};  ///< of those
  Status feed = Status::kOk;                ///< status of the last day-ahead request
  std::int64_t planned_utc_s = 0;           ///< newest planned tick, else the first of all
};

/// Rows of the next ticks, at the two levels that enclose the next decision's level.
struct OutlookPlanRows {
  static constexpr int kTicks = 15;  ///< bess-prices may be half an hour late
  static constexpr int kLevels = 2;

  std::int64_t first_tick_utc_s = 0;
  int ticks = 0;  ///< at most until midnight
  int levels = 0;
  std::int32_t level_centi[kLevels] = {};
  BreakEvenRow rows[kLevels][kTicks] = {};
  bool is_published = false;  ///< price of the first tick's quarter-hour
  std::int16_t known_quarter_hours = 0;
  PricedQuarterHour dearest{}, cheapest{};
  Status feed = Status::kOk;
};

/// A day without day-ahead prices, by local quarter-hour: the fallback.
struct UsualDay {
  std::int32_t level_centi = 0;
  BreakEvenRow rows[kQuarterHourCount] = {};
};

/// Part of the published record (edge/prices/record) for a student by outlook.
struct PublishedOutlook {
  OutlookPlanRows plan_rows{};
  UsualDay usual{};
};

/// Plan from the published record, for the control loop.
struct OutlookExchange : PublishedOutlook {
  const OutlookModel* model = nullptr;
};

/// At a tick, at the level of its decision. Sets all fields but `planned_utc_s`.
OutlookReport outlook_at(const OutlookExchange& exchange, std::int64_t tick_utc_s,
                         std::int32_t soc_e4, std::int32_t level_centi);

}  // namespace bess
