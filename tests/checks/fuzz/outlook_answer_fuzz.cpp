// Day-ahead answers as the edge accepts them, and the file that preserves them over a restart.
#include "edge/prices/fetch/day_ahead_feed.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "tests/checks/fuzz/scratch_file.h"

namespace bess {
namespace {

constexpr std::int64_t kNow_utc_s = 1'749'639'480;  // 11 June 2025, 12:58 in Brussels

/// Checks prices that may be used for planning.
void check_known(const DayAheadStore& store) {
  const OutlookDays days = store.days_at(kNow_utc_s);
  for (std::int64_t t = days.today_utc_s; t < days.end_utc_s; t += kSecondsPerQuarterHour) {
    const std::int32_t centi = days.day_ahead_centi[days.index_of(t)];
    if (centi == kDayAheadUnknown) continue;
    must(t < days.tomorrow_utc_s, "nothing of tomorrow is known before 13:00");
    must(centi >= -kPlausiblePriceMaxCentiEurPerMwh && centi <= kPlausiblePriceMaxCentiEurPerMwh,
         "a plausible price");
  }
}

void check_answer(std::string_view text, const PriceFields& fields) {
  const DayAheadReply reply = read_day_ahead(text, fields);
  if (reply.status != Status::kOk) return;
  DayAheadStore store;
  const Status first = store.take(reply.days, kNow_utc_s);
  check_known(store);
  const std::uint32_t changes = store.changes();
  must(first != Status::kNoRow || changes == 0, "what is refused whole is not kept");
  static_cast<void>(store.take(reply.days, kNow_utc_s + 60));
  must(store.changes() == changes, "the same again is nothing new");
}

/// Without a valid checksum nothing is restored; with one, nothing that no run writes.
void check_kept(std::string_view text) {
  static const ScratchFile file("day_ahead");
  DayAheadStore store;
  const int restored = restore_day_ahead(file.holding(text).c_str(), store);
  must(restored >= 0 && restored <= DayAheadStore::kPricesMax, "no more than a book holds");
  check_known(store);
}

}  // namespace
}  // namespace bess

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  static const bool time_zone_set = (set_market_time_zone(), true);
  static_cast<void>(time_zone_set);
  const std::string_view text = text_of(data, size);
  check_answer(text, OutlookSettings{}.fields);
  check_answer(text, {.rows = "data.rows", .time = "start", .price = "eur"});
  if (text.starts_with('#')) check_kept(text);
  return 0;
}
