#include "tools/simulators/market_sim/auction_view.h"

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/json.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kHour_s = 3'600;

/// UTC of a local minute on the local day of the instant.
std::int64_t local_at(std::int64_t utc_s, int minute) {
  const LocalMinute local = local_minute_of(utc_s);
  return utc_from_local({local.year, local.month, local.day, minute / 60, minute % 60, 0});
}

/// Noon of a date; an empty text changes nothing.
bool take_date(const std::string& text, std::int64_t& utc_s) {
  return text.empty() || (text.size() == 10 && parse_utc(text + "T12:00:00Z", utc_s));
}

AuctionAnswer refusal(int status, const char* detail, AuctionFault fault = AuctionFault::kNone) {
  return {status, Json::object({{"detail", detail}}).line(), fault};
}

std::string energy_charts(const std::vector<AuctionRow>& rows) {
  Json seconds = Json::list(), prices = Json::list();
  for (const AuctionRow& row : rows) {
    seconds.add(row.utc_s);
    prices.add(Decimals{row.eur_per_mwh, 2});
  }
  return Json::object({{"license_info", "simulated by bess-sim market, no real prices"},
                       {"unix_seconds", std::move(seconds)},
                       {"price", std::move(prices)},
                       {"unit", "EUR / MWh"},
                       {"deprecated", false}})
      .line();
}

}  // namespace

std::vector<AuctionRow> parse_auction_rows(std::string_view text, const std::string& name) {
  const CsvTable table(text, name,
                       "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc");
  std::vector<AuctionRow> rows;
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    const double step_min = table.number(r, 2);
    const AuctionRow row{table.utc_s(r, 0), table.number(r, 1),
                         static_cast<std::int64_t>(60 * step_min),
                         table.text(r, 3).empty() ? 0 : table.utc_s(r, 3)};
    const bool is_next = rows.empty() || row.utc_s > rows.back().utc_s;
    const bool is_step = step_min == 15 || step_min == 30 || step_min == 60;
    if (!is_next || !is_step || row.utc_s % kSecondsPerQuarterHour != 0) {
      fail("{}:{}: must be a later quarter-hour than the previous row, of 15, 30 or 60 minutes",
           name, table.line(r));
    }
    rows.push_back(row);
  }
  return rows;
}

double AuctionView::price_at(std::int64_t utc_s, double otherwise) const {
  const auto row = std::ranges::lower_bound(rows_, utc_s, {}, &AuctionRow::utc_s);
  return row != rows_.end() && row->utc_s == utc_s ? row->eur_per_mwh : otherwise;
}

AuctionFault AuctionView::fault_of(std::int64_t published_utc_s, std::int64_t now_utc_s) const {
  const auto at_s = static_cast<double>(published_utc_s - settings_.start_utc_s);
  if (at_s < settings_.from_s || at_s >= settings_.to_s) return AuctionFault::kNone;
  const auto from_utc_s = settings_.start_utc_s + static_cast<std::int64_t>(settings_.from_s);
  const std::int64_t days =  // rounded: a day with a clock change has 23 or 25 hours
      (local_midnight_utc_s(published_utc_s) - local_midnight_utc_s(from_utc_s) +
       kSecondsPerDay / 2) /
      kSecondsPerDay;
  if ((days + 1) % settings_.every != 0) return AuctionFault::kNone;
  constexpr std::int64_t kCount = std::ssize(kAuctionFaultNames) - 2;  // without none and all
  const AuctionFault fault = settings_.fault == AuctionFault::kAll
                                 ? AuctionFault(1 + days / settings_.every % kCount)
                                 : settings_.fault;
  constexpr double kNever_s = std::numeric_limits<double>::infinity();
  const double usual_s = fault == AuctionFault::kLate ? 6. * kHour_s : kNever_s;
  const auto age_s = static_cast<double>(now_utc_s - published_utc_s);
  return age_s < settings_.repair_s.value_or(usual_s) ? fault : AuctionFault::kNone;
}

/// Appends the price of a quarter-hour, with its fault.
void AuctionView::add(AuctionFault fault, AuctionRow row, bool is_noon,
                      std::vector<AuctionRow>& published) const {
  if (fault == AuctionFault::kHours) {
    row.eur_per_mwh = price_at(row.utc_s / kHour_s * kHour_s, row.eur_per_mwh);
  } else if (row.utc_s % row.step_s != 0) {
    return;  // repeated only in the file
  }
  if (fault == AuctionFault::kYesterday) {
    row.eur_per_mwh = price_at(row.utc_s - kSecondsPerDay, row.eur_per_mwh);
  }
  if (fault == AuctionFault::kShiftedHour) row.utc_s += kHour_s;
  if (fault == AuctionFault::kShiftedDay) row.utc_s += kSecondsPerDay;
  if (fault == AuctionFault::kOutOfRange && is_noon) row.eur_per_mwh = 150'000;
  published.push_back(row);
  row.eur_per_mwh += 50;
  if (fault == AuctionFault::kDoubled) published.push_back(row);
}

void AuctionView::add_day(std::int64_t midnight_utc_s, std::int64_t now_utc_s,
                          AuctionAnswer& answer, std::vector<AuctionRow>& published) const {
  auto row = std::ranges::lower_bound(rows_, midnight_utc_s, {}, &AuctionRow::utc_s);
  const bool is_noted = row != rows_.end() && row->published_utc_s != 0;
  const std::int64_t came_utc_s =
      is_noted ? row->published_utc_s
               : local_at(midnight_utc_s - kSecondsPerDay / 2, settings_.published_min);
  if (came_utc_s > now_utc_s) return;
  const AuctionFault fault = fault_of(came_utc_s, now_utc_s);
  if (fault != AuctionFault::kNone) answer.fault = fault;
  if (fault == AuctionFault::kLate || fault == AuctionFault::kMissing) return;
  const std::int64_t noon_utc_s = midnight_utc_s + kSecondsPerDay / 2;
  const std::int64_t end_utc_s =
      fault == AuctionFault::kHalf ? noon_utc_s : local_midnight_utc_s(midnight_utc_s, 1);
  for (; row != rows_.end() && row->utc_s < end_utc_s; ++row) {
    add(fault, *row, row->utc_s == noon_utc_s, published);
  }
}

AuctionAnswer AuctionView::answer(const std::string& start, const std::string& end,
                                  std::int64_t now_utc_s) const {
  std::int64_t from_utc_s = now_utc_s;
  if (!take_date(start, from_utc_s)) return refusal(422, "start is no date");
  std::int64_t to_utc_s = from_utc_s;
  if (!take_date(end, to_utc_s)) return refusal(422, "end is no date");
  AuctionAnswer answer;
  std::vector<AuctionRow> published;
  const std::int64_t last_utc_s = std::min(to_utc_s, rows_.back().utc_s);
  for (std::int64_t midnight_utc_s =
           local_midnight_utc_s(std::max(from_utc_s, rows_.front().utc_s));
       midnight_utc_s <= last_utc_s; midnight_utc_s = local_midnight_utc_s(midnight_utc_s, 1)) {
    add_day(midnight_utc_s, now_utc_s, answer, published);
  }
  if (answer.fault == AuctionFault::kHtml) {
    answer.body = "<!DOCTYPE html><html><body><h1>Down for maintenance</h1></body></html>\n";
  } else if (published.empty()) {
    return refusal(404, "no content available", answer.fault);
  } else {
    answer.body = energy_charts(published);
  }
  return answer;
}

}  // namespace bess
