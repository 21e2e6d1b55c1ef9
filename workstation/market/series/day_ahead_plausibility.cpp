#include "workstation/market/series/day_ahead_plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "shared/host/day_ahead_rows.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

constexpr std::size_t kDayOfPrices = 96;
constexpr std::size_t kSharedMin = 80 * kDayOfPrices;  ///< fewer may mislead
constexpr double kCorrelationMore = 0.02;              ///< that a shift must have
/// Limits of the coupled auction, raised by steps when reached (harmonised clearing prices).
constexpr double kAuctionMinEurPerMwh = -500, kAuctionMaxEurPerMwh = 5'000;
constexpr double kNoDayStaysWithinEurPerMwh = 5;  ///< as in EUR/kWh
constexpr std::int64_t kYear2000_s = 946'684'800, kYear2100_s = 4'102'444'800;

class DayAheadJudge {
 public:
  explicit DayAheadJudge(const DayAheadSeries& series) : series_(series) {}

  std::vector<Finding> findings() {
    if (series_.start_utc_s < kYear2000_s || series_.end_utc_s() > kYear2100_s) {
      error("dates", 0, "the year cannot be meant; mend the times");
    }
    check_prices();
    check_column();
    check_days();
    return std::move(findings_);
  }

 private:
  void error(std::string_view name, std::size_t q, std::string what) {
    findings_.push_back({name, true, std::move(what), series_.utc_s(q)});
  }
  void warning(std::string_view name, std::size_t q, std::string what) {
    findings_.push_back({name, false, std::move(what), series_.utc_s(q)});
  }

  template <typename Wanted>
  void tell_first(std::string_view name, bool is_error, Wanted wanted, const char* what) {
    std::size_t count = 0;
    std::size_t first = 0;
    for (std::size_t q = 0; q < series_.size(); ++q) {
      if (is_published(series_.eur_per_mwh[q]) && wanted(series_.eur_per_mwh[q]) && count++ == 0) {
        first = q;
      }
    }
    if (count == 0) return;
    findings_.push_back({name, is_error,
                         fmt::format("day-ahead price {} {} ({})", series_.eur_per_mwh[first], what,
                                     counted(count, "quarter-hour")),
                         series_.utc_s(first)});
  }

  void check_prices() {
    tell_first("sentinel", true, is_day_ahead_sentinel,
               "stands for \"no price\"; leave the row out if your source says so");
    tell_first(
        "price-range", true,
        [](double price) { return std::fabs(price) > kPlausiblePriceMaxEurPerMwh; },
        "lies beyond what any market allows; mend it or leave the row out");
    tell_first(
        "unusual-price", false,
        [](double price) {
          return (price < kAuctionMinEurPerMwh || price > kAuctionMaxEurPerMwh) &&
                 std::fabs(price) <= kPlausiblePriceMaxEurPerMwh;
        },
        "lies beyond the auction's limits of -500 and 5000 EUR/MWh: taken as it is");
  }

  void check_column() {
    std::size_t count = 0;
    double size_max = 0;
    double first = kNotPublished;
    bool is_constant = true;
    for (const double price : series_.eur_per_mwh) {
      if (!is_published(price)) continue;
      if (count++ == 0) first = price;
      is_constant = is_constant && price == first;
      size_max = std::max(size_max, std::fabs(price));
    }
    if (count < kDayOfPrices) return;
    if (is_constant) {
      return error("constant", 0,
                   fmt::format("every day-ahead price is {:g}; get the prices again", first));
    }
    if (size_max >= kNoDayStaysWithinEurPerMwh) return;
    error("price-unit", 0,
          fmt::format("no day-ahead price exceeds {:g}: EUR/kWh? prices are in EUR/MWh, multiply "
                      "by 1000",
                      size_max));
  }

  /// Whether the day [from, from + 96) has the prices of the day before it, of which not all are
  /// one.
  [[nodiscard]] bool repeats_day_before(std::size_t from) const {
    bool moves = false;
    for (std::size_t q = from; q < from + kDayOfPrices; ++q) {
      const double price = series_.eur_per_mwh[q];
      if (!(price == series_.eur_per_mwh[q - kDayOfPrices]))
        return false;  // nor where one is missing
      moves = moves || price != series_.eur_per_mwh[from];
    }
    return moves;
  }

  void check_days() {
    const std::vector<IncompleteDay> incomplete = incomplete_days(series_);
    if (!incomplete.empty()) {
      const IncompleteDay& day = incomplete.front();
      warning(
          "gaps", 0,
          fmt::format("{} with fewer day-ahead prices than quarter-hours, first {}: {} of {}",
                      counted(incomplete.size(), "day"), day.date, day.prices, day.quarter_hours));
    }
    const std::int64_t into_day_s =
        series_.start_utc_s - local_midnight_utc_s(local_date_of(series_.start_utc_s));
    const auto before =
        static_cast<std::size_t>((86'400 - into_day_s) / kSecondsPerQuarterHour) % kDayOfPrices;
    for (std::size_t q = before + kDayOfPrices; q + kDayOfPrices <= series_.size(); ++q) {
      const bool midnight = local_minute_of(series_.utc_s(q)).minute_of_day == 0;
      if (!midnight || !repeats_day_before(q)) continue;
      return error("repeated-day", q,
                   fmt::format("the day-ahead prices of {} are those of the day before: an old "
                               "answer? get the day again",
                               format_local_date(local_date_of(series_.utc_s(q)))));
    }
  }

  const DayAheadSeries& series_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> implausible_day_ahead(const DayAheadSeries& series) {
  return series.size() == 0 ? std::vector<Finding>{} : DayAheadJudge(series).findings();
}

namespace {

struct SharedPrices {
  std::size_t count = 0;
  double correlation = kNotPublished;
};

SharedPrices compare(const DayAheadSeries& day_ahead, const MinuteSeries& settled, int days_later) {
  double n = 0, x = 0, y = 0, xx = 0, yy = 0, xy = 0;
  for (std::size_t q = 0; q < day_ahead.size(); ++q) {
    const double expected = day_ahead.eur_per_mwh[q];
    const std::int64_t utc_s = day_ahead.utc_s(q) + std::int64_t{days_later} * 86'400;
    const std::int64_t minute = (utc_s - settled.start_utc_s) / 60;
    if (!is_published(expected) || utc_s < settled.start_utc_s ||
        minute >= static_cast<std::int64_t>(settled.size())) {
      continue;
    }
    const double paid = settled.settled[static_cast<std::size_t>(minute)];
    if (!is_published(paid)) continue;
    n += 1, x += expected, y += paid;
    xx += expected * expected, yy += paid * paid, xy += expected * paid;
  }
  SharedPrices shared{static_cast<std::size_t>(n)};
  const double spread = (n * xx - x * x) * (n * yy - y * y);
  if (shared.count >= kDayOfPrices && spread > 0) {
    shared.correlation = (n * xy - x * y) / std::sqrt(spread);
  }
  return shared;
}

}  // namespace

double day_ahead_correlation(const DayAheadSeries& day_ahead, const MinuteSeries& settled,
                             int days_later) {
  return compare(day_ahead, settled, days_later).correlation;
}

std::vector<Finding> shifted_day_ahead(const DayAheadSeries& day_ahead,
                                       const MinuteSeries& settled) {
  const SharedPrices as_filed = compare(day_ahead, settled, 0);
  if (as_filed.count < kSharedMin) return {};
  for (const int days : {1, -1}) {
    const double shifted = day_ahead_correlation(day_ahead, settled, days);
    if (!(shifted > as_filed.correlation + kCorrelationMore)) continue;
    return {
        {"shifted-day",
         true,
         fmt::format("the day-ahead prices follow the settled ones better a day {} (correlation "
                     "{:.2f}, as filed {:.2f}): are they filed under the wrong day? mend the "
                     "dates",
                     days > 0 ? "later" : "earlier", shifted, as_filed.correlation),
         {}}};
  }
  return {};
}

}  // namespace bess
