#include "tools/simulators/market_sim/market_view.h"

#include <algorithm>
#include <cmath>

#include "shared/host/json.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::string offset_time(std::int64_t utc_s) {
  std::string text(utc_text(utc_s).view());
  text.pop_back();  // Z
  return text + "+00:00";
}

/// Answer changed by a fault of its text; other faults have no effect.
std::string spoilt(MarketFault fault, std::string answer) {
  if (fault == MarketFault::kGarbage) return "{\"results\": [{\"dat";
  if (fault == MarketFault::kTrailing) return answer + answer;
  if (fault != MarketFault::kTwice) return answer;
  constexpr std::string_view kPrice = "\"imbalanceprice\":";
  constexpr std::string_view kTwice = "\"imbalanceprice\":-500.0,\"imbalanceprice\":";
  for (std::size_t at = 0; (at = answer.find(kPrice, at)) != answer.npos; at += kTwice.size()) {
    answer.replace(at, kPrice.size(), kTwice);
  }
  return answer;
}

}  // namespace

/// Index range of completed minutes of the last 24 hours; for past days, of all.
std::pair<std::size_t, std::size_t> MarketView::window(Dataset dataset,
                                                       std::int64_t now_utc_ns) const {
  const std::int64_t published_s = (now_utc_ns - latency_ns_) / kNanosecondsPerSecond - 60;
  const auto first_at_or_after = [this](std::int64_t utc_s) {
    const std::int64_t minute = (utc_s - prices_.start_utc_s + 59) / 60;
    return static_cast<std::size_t>(
        std::clamp<std::int64_t>(minute, 0, static_cast<std::int64_t>(prices_.size())));
  };
  if (dataset == Dataset::kMinutesOfPastDays) {
    return {0, first_at_or_after((published_s + 60) / kSecondsPerDay * kSecondsPerDay)};
  }
  return {first_at_or_after(published_s + 1 - kSecondsPerDay), first_at_or_after(published_s + 1)};
}

/// Minutes with a price, or the quarter-hours that they complete.
std::vector<MarketView::Row> MarketView::visible(Dataset dataset, std::int64_t now_utc_ns) const {
  constexpr std::int64_t kLastMinuteS = kSecondsPerQuarterHour - 60;
  const auto [begin, end] = window(dataset, now_utc_ns);
  std::vector<Row> rows;
  for (std::size_t m = begin; m < end; ++m) {
    const std::int64_t utc_s = prices_.utc_s(m);
    if (prices_.is_empty(m)) continue;
    if (dataset != Dataset::kQuarterHours) {
      rows.push_back({utc_s, prices_.indicative[m]});
    } else if (utc_s % kSecondsPerQuarterHour == kLastMinuteS) {
      rows.push_back({utc_s - kLastMinuteS, prices_.settled[m]});
    }
  }
  return rows;
}

/// Sets rows from `frozen_utc_s` on to the last price before it. Rows are ascending.
void MarketView::freeze(std::int64_t frozen_utc_s, std::vector<Row>& rows) {
  double price = std::nan("");
  for (Row& row : rows) {
    if (row.utc_s < frozen_utc_s) {
      price = row.price;
    } else if (!std::isnan(price)) {
      row.price = price;
    }
  }
}

std::string MarketView::records(const RecordsQuery& query, std::int64_t now_utc_ns,
                                MarketFault fault, std::int64_t fault_utc_s) const {
  const bool minutes = query.dataset != Dataset::kQuarterHours;
  if (fault == MarketFault::kStale) now_utc_ns -= kStaleAnswerS * kNanosecondsPerSecond;
  std::vector<Row> rows = visible(query.dataset, now_utc_ns);
  if (fault == MarketFault::kFrozen) freeze(fault_utc_s, rows);
  if (fault == MarketFault::kNull && !rows.empty()) rows.back().price = std::nan("");
  if (query.newest_first) std::reverse(rows.begin(), rows.end());
  const std::size_t first = std::min(rows.size(), static_cast<std::size_t>(query.offset));
  const std::size_t last = std::min(rows.size(), first + static_cast<std::size_t>(query.limit));
  Json results = Json::list();
  for (std::size_t i = first; i < last; ++i) {
    Json row = Json::object(
        {{"datetime", offset_time(rows[i].utc_s)}, {"resolutioncode", minutes ? "PT1M" : "PT15M"}});
    if (minutes)
      row.set("quarterhour",
              offset_time(rows[i].utc_s / kSecondsPerQuarterHour * kSecondsPerQuarterHour));
    row.set("qualitystatus", "NotValidated");
    row.set("imbalanceprice", Decimals{rows[i].price, 3});
    results.add(std::move(row));
  }
  return spoilt(
      fault, Json::object({{"total_count", rows.size()}, {"results", std::move(results)}}).line());
}

}  // namespace bess
