// What a student by outlook is given at a tick: the break-even price that a plan on day-ahead
// prices has for this moment and SoC (shared/outlook). Plans are made on a thread of their own
// (edge/prices/fetch), which offers the rows of the ticks ahead; a cycle takes what is there.
//   planned   made for this tick, and the price of its quarter-hour was published
//   usual     made for this tick, and it was not: what is usual at this hour and level
//   late      the thread has not kept up: of a plan for an earlier tick, or another level
//   missing   nothing is offered for this tick: the usual day, found at the start
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

#include "edge/core/base/status.h"
#include "shared/outlook/outlook_plan.h"

namespace bess {

// The newest value of a kind from one thread to another, larger than a word: of three places one is
// being written, one being read, and one holds what was posted last. Neither side ever waits.

template <typename Value>
class Mailbox {
 public:
  /// The writer's place, with what it held some posts ago.
  Value& draft() { return places_[writing_]; }
  void post() {
    writing_ = handed_over_.exchange(static_cast<std::uint8_t>(writing_ | kNew),
                                     std::memory_order_acq_rel) &
               kPlace;
  }
  /// The reader's: what was posted last; before anything was, a value by default.
  const Value& latest() {
    if ((handed_over_.load(std::memory_order_relaxed) & kNew) != 0) {
      reading_ = handed_over_.exchange(reading_, std::memory_order_acq_rel) & kPlace;
    }
    return places_[reading_];
  }

 private:
  static constexpr std::uint8_t kPlace = 3, kNew = 4;

  Value places_[3]{};
  std::atomic<std::uint8_t> handed_over_{0};
  std::uint8_t writing_ = 1, reading_ = 2;
};

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

/// What a cycle made of it, for the log; nothing where the context is another.
struct OutlookReport {
  OutlookSource source = OutlookSource::kNone;
  std::int32_t break_even_centi = 0;
  std::int16_t known_quarter_hours = 0;     ///< published, from the tick on
  PricedQuarterHour dearest{}, cheapest{};  ///< of those
  Status feed = Status::kOk;                ///< how day-ahead prices were last answered
  std::int64_t planned_utc_s = 0;           ///< newest tick that was planned, else the first of all
};

/// The rows of the next ticks, at the two levels between which the next decision's must lie.
struct OutlookOffer {
  static constexpr int kTicks = 15;  ///< half an hour that the planning thread may be late
  static constexpr int kLevels = 2;

  std::int64_t first_tick_utc_s = 0;
  int ticks = 0;  ///< no further than to midnight
  int levels = 0;
  std::int32_t level_centi[kLevels] = {};
  BreakEvenRow rows[kLevels][kTicks] = {};
  bool is_published = false;  ///< the price of the first tick's quarter-hour
  std::int16_t known_quarter_hours = 0;
  PricedQuarterHour dearest{}, cheapest{};
  Status feed = Status::kOk;
};

/// A day without any day-ahead price, by local quarter-hour: what there is where nothing else is.
struct UsualDay {
  std::int32_t level_centi = 0;
  BreakEvenRow rows[kQuarterHourCount] = {};
};

/// Where planning thread and control thread meet.
struct OutlookBoard {
  const OutlookModel* model = nullptr;
  UsualDay usual{};  ///< written before the loop starts
  Mailbox<OutlookOffer> offers{};
};

/// At a tick, at the level of its decision. Everything but `planned_utc_s`.
OutlookReport outlook_at(OutlookBoard& board, std::int64_t tick_utc_s, std::int32_t soc_e4,
                         std::int32_t level_centi);

}  // namespace bess
