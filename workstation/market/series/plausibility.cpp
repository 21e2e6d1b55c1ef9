#include "workstation/market/series/plausibility.h"

#include <fmt/core.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "shared/host/day_ahead_rows.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/market/series/gaps.h"
#include "workstation/market/series/local_date.h"

namespace bess {

namespace {

/// As the edge refuses and tells them.
constexpr double kPriceMaxEurPerMwh = kPlausiblePriceMaxEurPerMwh;
constexpr double kUsualPriceMaxEurPerMwh = kUnusualPriceMaxEurPerMwh;
/// No day of a balancing market stays within it; every one does when counted in EUR/kWh.
constexpr double kUnitLowMax = 5;
/// The median of no market; that of every market in cents.
constexpr double kUnitHighMin = 1'500, kUnitHighMax = 1.5e6;
constexpr std::size_t kJudgedMin = 1'440;  // a day's worth of prices
constexpr std::int64_t kGapWorthNaming_min = 60;
constexpr double kGapShareMax = 0.05;
constexpr std::int64_t kEarliest_s = 946'684'800;  // 2000-01-01
constexpr std::int64_t kLatest_s = 4'102'444'800;  // 2100-01-01
/// What databases and instruments write where there is no value, and what no market has settled at
/// or limits its bids to.
constexpr std::array kSentinels{-9'999.0, 9'999.0, -9'999.99, 9'999.99};
/// What they write as well, and what is a price: seven quarter-hours of Belgium's 2025 were settled
/// at -999, and bids end at +-99,999. Only many of them together are suspect.
constexpr std::array kAlsoPrices{-999.0, -99'999.0, 99'999.0};
constexpr double kAlsoPricesShareMax = 0.01;  ///< -999 had 0.02 % of 2025

struct Column {
  const char* name;
  std::span<const double> prices;
};

/// Of the published prices of a column.
struct Summary {
  std::size_t count = 0;
  std::optional<std::size_t> first;
  double size_max = 0;  ///< of |price|
  bool is_constant = true;
};

Summary summary_of(const Column& column) {
  Summary summary;
  for (std::size_t m = 0; m < column.prices.size(); ++m) {
    const double price = column.prices[m];
    if (!is_published(price)) continue;
    if (!summary.first) summary.first = m;
    ++summary.count;
    summary.size_max = std::max(summary.size_max, std::fabs(price));
    summary.is_constant = summary.is_constant && price == column.prices[*summary.first];
  }
  return summary;
}

double median_size(const Column& column) {
  std::vector<double> sizes;
  for (const double price : column.prices) {
    if (is_published(price)) sizes.push_back(std::fabs(price));
  }
  const auto middle = sizes.begin() + static_cast<std::ptrdiff_t>(sizes.size() / 2);
  std::nth_element(sizes.begin(), middle, sizes.end());
  return *middle;
}

/// Minutes whose price `wanted` names: how many, and the first.
template <typename Wanted>
std::pair<std::size_t, std::size_t> matches(std::span<const double> prices, Wanted wanted) {
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t m = 0; m < prices.size(); ++m) {
    if (is_published(prices[m]) && wanted(prices[m]) && count++ == 0) first = m;
  }
  return {count, first};
}

class Judge {
 public:
  explicit Judge(const MinuteSeries& series) : series_(series) {}

  std::vector<Finding> findings() {
    check_dates();
    for_columns(&Judge::check_row_step);
    for_columns(&Judge::check_constant);
    for_columns(&Judge::check_sentinels);
    for_columns(&Judge::check_frequent_sentinels);
    for_columns(&Judge::check_unit);
    for_columns(&Judge::check_range);
    for_columns(&Judge::check_unusual);
    check_settled_changes();
    for_columns(&Judge::check_frozen);
    check_copied();
    for_columns(&Judge::check_gaps);
    return std::move(findings_);
  }

 private:
  void for_columns(void (Judge::*check)(const Column&)) {
    (this->*check)({"settled", series_.settled});
    (this->*check)({"indicative", series_.indicative});
  }
  void error(std::string_view name, std::size_t minute, std::string what) {
    findings_.push_back({name, true, std::move(what), series_.utc_s(minute)});
  }
  void warning(std::string_view name, std::int64_t utc_s, std::string what) {
    findings_.push_back({name, false, std::move(what), utc_s});
  }

  void check_dates() {
    const std::size_t last = series_.size() - 1;
    const bool early = series_.start_utc_s < kEarliest_s;
    if (!early && series_.utc_s(last) < kLatest_s) return;
    error("dates", early ? 0 : last, "the year cannot be meant; mend the times");
  }

  /// Minutes between rows as they usually follow each other; 1 when there are too few to say.
  static std::size_t usual_step(std::span<const double> prices, std::size_t first,
                                std::size_t stride) {
    constexpr std::size_t kStepsMin = 8;
    std::map<std::size_t, std::size_t> count_of_step;
    std::optional<std::size_t> before;
    std::size_t steps = 0;
    for (std::size_t m = first; m < prices.size(); m += stride) {
      if (!is_published(prices[m])) continue;
      if (before) ++count_of_step[m - *before];
      steps += before ? 1 : 0;
      before = m;
    }
    if (steps < kStepsMin) return stride;
    return std::ranges::max_element(count_of_step, {}, [](const auto& step) { return step.second; })
        ->first;
  }

  void check_row_step(const Column& column) {
    const std::optional<std::size_t> first_price = summary_of(column).first;
    if (!first_price) return;
    const std::size_t first = *first_price;
    const std::size_t step = usual_step(column.prices, 0, 1);
    if (step > 1) {
      error("row-step", first,
            fmt::format("{} prices come every {} minutes, and a minute file has one a minute; "
                        "'bess-train prices reconstruct --quarter-hours' builds minutes on "
                        "quarter-hours",
                        column.name, step));
      return;
    }
    const std::size_t quarter_hour = kSecondsPerQuarterHour / 60;
    const std::size_t begin = static_cast<std::size_t>(
        (kSecondsPerQuarterHour - series_.start_utc_s % kSecondsPerQuarterHour) %
        kSecondsPerQuarterHour / 60);
    const std::size_t rows_apart = usual_step(column.prices, begin, quarter_hour);
    if (rows_apart > quarter_hour) {
      error("row-step", first,
            fmt::format("{} prices come every {} minutes, and the market settles every 15: get "
                        "quarter-hours",
                        column.name, rows_apart));
    }
  }

  void check_constant(const Column& column) {
    const Summary summary = summary_of(column);
    if (summary.count < kJudgedMin || !summary.is_constant) return;
    const double price = column.prices[*summary.first];
    error("constant", *summary.first,
          fmt::format("every {} price is {:g}, in {} minutes; nothing can be learnt from it, get "
                      "the prices again",
                      column.name, price, summary.count));
  }

  void check_sentinels(const Column& column) {
    const auto is_sentinel = [](double price) {
      return std::ranges::find(kSentinels, price) != kSentinels.end();
    };
    const auto [count, first] = matches(column.prices, is_sentinel);
    if (count == 0) return;
    error("sentinel", first,
          fmt::format("{} price {} stands for \"no price\" ({}); leave the field empty if your "
                      "source says so",
                      column.name, column.prices[first], counted(count, "minute")));
  }

  void check_frequent_sentinels(const Column& column) {
    const std::size_t prices = summary_of(column).count;
    if (prices < kJudgedMin) return;
    for (const double wanted : kAlsoPrices) {
      const auto [count, first] =
          matches(column.prices, [wanted](double price) { return price == wanted; });
      const double share = static_cast<double>(count) / static_cast<double>(prices);
      if (share <= kAlsoPricesShareMax) continue;
      warning("sentinel", series_.utc_s(first),
              fmt::format("{} price {} in {:.1f} % of the minutes: is it what your source writes "
                          "for \"no price\"? then leave the field empty",
                          column.name, wanted, 100 * share));
    }
  }

  void check_unit(const Column& column) {
    const Summary summary = summary_of(column);
    if (summary.count < kJudgedMin || summary.is_constant) return;
    if (summary.size_max < kUnitLowMax) {
      error("price-unit", *summary.first,
            fmt::format("no {} price exceeds {:g}: EUR/kWh? prices are in EUR/MWh, multiply by "
                        "1000",
                        column.name, summary.size_max));
    }
    if (summary.size_max < kUnitHighMin) return;
    const double median = median_size(column);
    if (median >= kUnitHighMin && median <= kUnitHighMax) {
      error("price-unit", *summary.first,
            fmt::format("half of the {} prices exceed {:.0f}: cents? prices are in EUR/MWh, divide "
                        "by 100",
                        column.name, median));
    }
  }

  void check_range(const Column& column) {
    const auto is_beyond = [](double price) { return std::fabs(price) > kPriceMaxEurPerMwh; };
    const auto [count, first] = matches(column.prices, is_beyond);
    if (count == 0) return;
    error("price-range", first,
          fmt::format("{} price {} lies beyond {:.0f} EUR/MWh, more than any market allows ({}); "
                      "mend it or leave it empty",
                      column.name, column.prices[first], kPriceMaxEurPerMwh,
                      counted(count, "minute")));
  }

  /// Nothing is done about them: the dearest minutes of a year are what a battery is for.
  void check_unusual(const Column& column) {
    const auto is_unusual = [](double price) {
      return std::fabs(price) > kUsualPriceMaxEurPerMwh && std::fabs(price) <= kPriceMaxEurPerMwh;
    };
    const auto [count, first] = matches(column.prices, is_unusual);
    if (count == 0) return;
    warning("unusual-price", series_.utc_s(first),
            fmt::format("{} price {} lies beyond {:.0f} EUR/MWh ({}): taken as it is, markets have "
                        "settled there",
                        column.name, column.prices[first], kUsualPriceMaxEurPerMwh,
                        counted(count, "minute")));
  }

  /// The settled price belongs to the quarter-hour; when the other column keeps still instead, the
  /// two are swapped.
  void check_settled_changes() {
    std::size_t changing = 0;
    std::size_t first = 0;
    std::size_t still_indicative = 0;
    for (std::size_t m = 1; m < series_.size(); ++m) {
      const bool same = series_.utc_s(m) % kSecondsPerQuarterHour != 0;
      const auto changes = [&](const std::vector<double>& prices) {
        return is_published(prices[m - 1]) && is_published(prices[m]) && prices[m] != prices[m - 1];
      };
      if (!same || !changes(series_.settled)) continue;
      if (changing++ == 0) first = m;
      still_indicative += changes(series_.indicative) ? 0 : 1;
    }
    if (changing == 0) return;
    const bool swapped = changing > 100 && still_indicative * 10 > changing * 9;
    error(
        "settled-changes", first,
        fmt::format("the settled price changes within its quarter-hour, from {:g} to {:g} ({}); {}",
                    series_.settled[first - 1], series_.settled[first], counted(changing, "change"),
                    swapped ? "the indicative price does not: are the two columns swapped?"
                            : "a quarter-hour has one settled price, mend the rows"));
  }

  void check_frozen(const Column& column) {
    if (summary_of(column).is_constant) return;  // said already
    std::size_t longest = 0;
    std::size_t start_of_longest = 0;
    std::size_t start = 0;
    for (std::size_t m = 0; m < column.prices.size(); ++m) {
      if (m == 0 || column.prices[m] != column.prices[m - 1]) start = m;  // NaN differs from NaN
      if (m + 1 - start > longest) {
        longest = m + 1 - start;
        start_of_longest = start;
      }
    }
    if (longest < kJudgedMin) return;
    warning("frozen", series_.utc_s(start_of_longest),
            fmt::format("the {} price stays at {:g} for {} minutes; did the source hang?",
                        column.name, column.prices[start_of_longest], longest));
  }

  void check_copied() {
    std::size_t both = 0;
    for (std::size_t m = 0; m < series_.size(); ++m) {
      if (!is_published(series_.indicative[m]) || !is_published(series_.settled[m])) continue;
      if (series_.indicative[m] != series_.settled[m]) return;
      ++both;
    }
    if (both < kJudgedMin || summary_of({"settled", series_.settled}).is_constant) return;
    warning("copied-column", series_.start_utc_s,
            "indicative and settled price are the same in every minute: a policy would see what it "
            "will be paid, and its figures flatter");
  }

  /// Ends are no gaps: what came before the first price or will be settled later is not missing.
  void check_gaps(const Column& column) {
    const Summary summary = summary_of(column);
    if (summary.count == 0) return;
    std::vector<Gap> gaps = gaps_in(column.prices, series_.start_utc_s, 60);
    std::erase_if(gaps, [this](const Gap& gap) {
      return gap.from_utc_s == series_.start_utc_s ||
             gap.until_utc_s == series_.utc_s(series_.size());
    });
    if (gaps.empty()) return;
    const auto length_min = [](const Gap& gap) { return (gap.until_utc_s - gap.from_utc_s) / 60; };
    const Gap largest = *std::ranges::max_element(gaps, {}, length_min);
    const std::int64_t missing_min = minutes_in(gaps);
    const double share = static_cast<double>(missing_min) / static_cast<double>(series_.size());
    if (length_min(largest) < kGapWorthNaming_min && share <= kGapShareMax) return;
    warning("gaps", largest.until_utc_s,
            fmt::format("{} price: {}, {} of {} minutes missing; the largest, {} minutes, from {} "
                        "to {}",
                        column.name, counted(gaps.size(), "gap"), missing_min, series_.size(),
                        length_min(largest), utc_text(largest.from_utc_s).view(),
                        utc_text(largest.until_utc_s).view()));
  }

  const MinuteSeries& series_;
  std::vector<Finding> findings_;
};

}  // namespace

std::vector<Finding> implausible(const MinuteSeries& series) {
  if (series.size() == 0) return {};
  return Judge(series).findings();
}

std::vector<Finding> implausible_end(std::string_view text, const MinuteSeries& series) {
  if (text.empty() || text.ends_with('\n') || series.size() == 0) return {};
  const std::size_t last = series.size() - 1;
  const bool first_of_quarter_hour = series.utc_s(last) % kSecondsPerQuarterHour == 0;
  const bool contradicts = last > 0 && !first_of_quarter_hour &&
                           is_published(series.settled[last - 1]) &&
                           !(series.settled[last] == series.settled[last - 1]);
  return {{"cut-end", contradicts,
           "the last row does not end with a line end: the file may be cut off; get it again, or "
           "delete the row",
           series.utc_s(last)}};
}

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
        static_cast<std::size_t>((kSecondsPerDay - into_day_s) / kSecondsPerQuarterHour) %
        kDayOfPrices;
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
    const std::int64_t utc_s = day_ahead.utc_s(q) + std::int64_t{days_later} * kSecondsPerDay;
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
