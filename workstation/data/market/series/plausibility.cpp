#include "workstation/data/market/series/plausibility.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <span>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

/// Limit of the edge.
constexpr double kPriceMaxEurPerMwh = kPlausiblePriceMaxEurPerMwh;
/// Every market exceeds it within a day; prices in EUR/kWh never do.
constexpr double kUnitLowMax = 5;
/// Range of the median of prices in cents; no market has such a median in EUR/MWh.
constexpr double kUnitHighMin = 1'500, kUnitHighMax = 1.5e6;
constexpr std::int64_t kGapWorthNaming_min = 60;
constexpr double kGapShareMax = 0.05;
constexpr std::size_t kGapsListed = 5;
constexpr std::int64_t kEarliest_s = 946'684'800;  // 2000-01-01
constexpr std::int64_t kLatest_s = 4'102'444'800;  // 2100-01-01
/// Placeholders of databases and instruments for missing values that no market has settled at or
/// uses as a bid limit.
constexpr std::array kSentinels{-9'999.0, 9'999.0, -9'999.99, 9'999.99};
/// Placeholders that are also prices: seven quarter-hours of Belgium's 2025 were settled at -999,
/// and bids end at +-99,999. Suspect only if frequent.
constexpr std::array kAlsoPrices{-999.0, -99'999.0, 99'999.0};
constexpr double kAlsoPricesShareMax = 0.01;  ///< -999 had 0.02 % of 2025

/// Prices in evenly spaced rows with their properties, and statistics of the published ones.
struct Column {
  const char* name;
  std::span<const double> prices;
  std::int64_t start_utc_s;
  std::int64_t row_s;
  const char* row;
  double usual_min_eur_per_mwh, usual_max_eur_per_mwh;
  bool (*is_sentinel)(double);

  std::size_t count = 0;
  std::optional<std::size_t> first{};
  double size_max = 0;  ///< of |price|
  bool is_constant = true;

  [[nodiscard]] std::int64_t utc_s(std::size_t i) const {
    return start_utc_s + static_cast<std::int64_t>(i) * row_s;
  }
  /// One day of prices: the minimum for checks of a whole column.
  [[nodiscard]] std::size_t judged_min() const {
    return static_cast<std::size_t>(kSecondsPerDay / row_s);
  }
};

Column with_statistics(Column column) {
  for (std::size_t m = 0; m < column.prices.size(); ++m) {
    const double price = column.prices[m];
    if (!is_published(price)) continue;
    if (!column.first) column.first = m;
    ++column.count;
    column.size_max = std::max(column.size_max, std::fabs(price));
    column.is_constant = column.is_constant && price == column.prices[*column.first];
  }
  return column;
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

/// Rows whose price is `wanted`: number and first.
template <typename Wanted>
std::pair<std::size_t, std::size_t> matches(std::span<const double> prices, Wanted wanted) {
  std::size_t count = 0;
  std::size_t first = 0;
  for (std::size_t m = 0; m < prices.size(); ++m) {
    if (is_published(prices[m]) && wanted(prices[m]) && count++ == 0) first = m;
  }
  return {count, first};
}

struct Findings {
  std::vector<Finding> all;

  template <typename... Args>
  void error(std::string_view name, const Column& column, std::size_t row,
             fmt::format_string<Args...> what, Args&&... args) {
    all.push_back({name, true, fmt::format(what, std::forward<Args>(args)...), column.utc_s(row)});
  }
  template <typename... Args>
  void warning(std::string_view name, std::int64_t utc_s, fmt::format_string<Args...> what,
               Args&&... args) {
    all.push_back({name, false, fmt::format(what, std::forward<Args>(args)...), utc_s});
  }
};

/// Adds what it finds in one column.
using Check = void (*)(const Column& column, Findings& findings);

void check_dates(const Column& column, Findings& findings) {
  const std::size_t last = column.prices.size() - 1;
  const bool early = column.start_utc_s < kEarliest_s;
  if (!early && column.utc_s(last) < kLatest_s) return;
  findings.error("dates", column, early ? 0 : last, "the year is impossible; correct the times");
}

void check_constant(const Column& column, Findings& findings) {
  if (column.count < column.judged_min() || !column.is_constant) return;
  const double price = column.prices[*column.first];
  findings.error("constant", column, *column.first,
                 "every {} price is {:g}, in {}; useless for training, download the prices again",
                 column.name, price, counted(column.count, column.row));
}

void check_sentinels(const Column& column, Findings& findings) {
  const auto [count, first] = matches(column.prices, column.is_sentinel);
  if (count == 0) return;
  findings.error("sentinel", column, first,
                 "{} price {} stands for \"no price\" ({}); leave it out if your source says so",
                 column.name, column.prices[first], counted(count, column.row));
}

void check_unit(const Column& column, Findings& findings) {
  if (column.count < column.judged_min() || column.is_constant) return;
  if (column.size_max < kUnitLowMax) {
    findings.error("price-unit", column, *column.first,
                   "no {} price exceeds {:g}: EUR/kWh? prices are in EUR/MWh, multiply by 1000",
                   column.name, column.size_max);
  }
  if (column.size_max < kUnitHighMin) return;
  const double median = median_size(column);
  if (median >= kUnitHighMin && median <= kUnitHighMax) {
    findings.error("price-unit", column, *column.first,
                   "half of the {} prices exceed {:.0f}: cents? prices are in EUR/MWh, divide "
                   "by 100",
                   column.name, median);
  }
}

void check_range(const Column& column, Findings& findings) {
  const auto is_beyond = [](double price) { return std::fabs(price) > kPriceMaxEurPerMwh; };
  const auto [count, first] = matches(column.prices, is_beyond);
  if (count == 0) return;
  findings.error("price-range", column, first,
                 "{} price {} is beyond {:.0f} EUR/MWh, more than any market allows ({}); "
                 "correct it or leave it empty",
                 column.name, column.prices[first], kPriceMaxEurPerMwh, counted(count, column.row));
}

/// Kept: the most expensive minutes of a year are the most valuable ones.
void check_unusual(const Column& column, Findings& findings) {
  const auto is_unusual = [&column](double price) {
    const bool is_usual =
        price >= column.usual_min_eur_per_mwh && price <= column.usual_max_eur_per_mwh;
    return !is_usual && std::fabs(price) <= kPriceMaxEurPerMwh;
  };
  const auto [count, first] = matches(column.prices, is_unusual);
  if (count == 0) return;
  findings.warning("unusual-price", column.utc_s(first),
                   "{} price {} is beyond {:.0f} .. {:.0f} EUR/MWh ({}): accepted", column.name,
                   column.prices[first], column.usual_min_eur_per_mwh, column.usual_max_eur_per_mwh,
                   counted(count, column.row));
}

/// Usual spacing of rows in minutes; 1 if there are too few.
std::size_t usual_step(std::span<const double> prices, std::size_t first, std::size_t stride) {
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

void check_row_step(const Column& column, Findings& findings) {
  if (!column.first) return;
  const std::size_t step = usual_step(column.prices, 0, 1);
  if (step > 1) {
    findings.error("row-step", column, *column.first,
                   "{} prices come every {} minutes, but a minute file has one per minute; "
                   "'bess-train prices reconstruct --quarter-hours' makes minutes from "
                   "quarter-hours",
                   column.name, step);
    return;
  }
  const std::size_t quarter_hour = kSecondsPerQuarterHour / 60;
  const std::size_t begin = static_cast<std::size_t>(
      (kSecondsPerQuarterHour - column.start_utc_s % kSecondsPerQuarterHour) %
      kSecondsPerQuarterHour / 60);
  const std::size_t rows_apart = usual_step(column.prices, begin, quarter_hour);
  if (rows_apart > quarter_hour) {
    findings.error("row-step", column, *column.first,
                   "{} prices come every {} minutes, but the market settles every 15; get "
                   "quarter-hours",
                   column.name, rows_apart);
  }
}

void check_frequent_sentinels(const Column& column, Findings& findings) {
  if (column.count < column.judged_min()) return;
  for (const double wanted : kAlsoPrices) {
    const auto [count, first] =
        matches(column.prices, [wanted](double price) { return price == wanted; });
    const double share = static_cast<double>(count) / static_cast<double>(column.count);
    if (share <= kAlsoPricesShareMax) continue;
    findings.warning("sentinel", column.utc_s(first),
                     "{} price {} in {:.1f} % of the minutes: is it what your source writes "
                     "for \"no price\"? then leave the field empty",
                     column.name, wanted, 100 * share);
  }
}

/// The settled price is constant in its quarter-hour; if the other column is constant instead,
/// the two are swapped.
void check_settled_changes(const MinuteSeries& series, const Column& settled, Findings& findings) {
  std::size_t changing = 0;
  std::size_t first = 0;
  std::size_t still_indicative = 0;
  for (std::size_t m = 1; m < series.size(); ++m) {
    const bool same = series.utc_s(m) % kSecondsPerQuarterHour != 0;
    const auto changes = [&](const std::vector<double>& prices) {
      return is_published(prices[m - 1]) && is_published(prices[m]) && prices[m] != prices[m - 1];
    };
    if (!same || !changes(series.settled)) continue;
    if (changing++ == 0) first = m;
    still_indicative += changes(series.indicative) ? 0 : 1;
  }
  if (changing == 0) return;
  const bool swapped = changing > 100 && still_indicative * 10 > changing * 9;
  findings.error("settled-changes", settled, first,
                 "the settled price changes within its quarter-hour, from {:g} to {:g} ({}); {}",
                 series.settled[first - 1], series.settled[first], counted(changing, "change"),
                 swapped ? "the indicative price does not: are the two columns swapped?"
                         : "a quarter-hour has one settled price, correct the rows");
}

void check_frozen(const Column& column, Findings& findings) {
  if (column.is_constant) return;  // already reported
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
  if (longest < column.judged_min()) return;
  findings.warning("frozen", column.utc_s(start_of_longest),
                   "the {} price stays at {:g} for {} minutes; did the source stop?", column.name,
                   column.prices[start_of_longest], longest);
}

void check_copied(const Column& settled, const Column& indicative, Findings& findings) {
  std::size_t both = 0;
  for (std::size_t m = 0; m < settled.prices.size(); ++m) {
    if (!is_published(indicative.prices[m]) || !is_published(settled.prices[m])) continue;
    if (indicative.prices[m] != settled.prices[m]) return;
    ++both;
  }
  if (both < settled.judged_min() || settled.is_constant) return;
  findings.warning(
      "copied-column", settled.start_utc_s,
      "indicative and settled price are equal in every minute: a policy would see the price "
      "that it is paid, and its results would be too high");
}

/// Time before the first and after the last price is not a gap.
void check_gaps(const Column& column, Findings& findings) {
  if (column.count == 0) return;
  std::vector<Gap> gaps = gaps_in(column.prices, column.start_utc_s, 60);
  std::erase_if(gaps, [&column](const Gap& gap) {
    return gap.from_utc_s == column.start_utc_s ||
           gap.until_utc_s == column.utc_s(column.prices.size());
  });
  if (gaps.empty()) return;
  const Gap largest = *std::ranges::max_element(gaps, {}, &Gap::minutes);
  const std::int64_t missing_min = minutes_in(gaps);
  const double share = static_cast<double>(missing_min) / static_cast<double>(column.prices.size());
  if (largest.minutes() < kGapWorthNaming_min && share <= kGapShareMax) return;
  findings.warning("gaps", largest.until_utc_s,
                   "{} price: {}, {} of {} minutes missing; the largest, {} minutes, from {} to {}",
                   column.name, counted(gaps.size(), "gap"), missing_min, column.prices.size(),
                   largest.minutes(), utc_text(largest.from_utc_s).view(),
                   utc_text(largest.until_utc_s).view());
}

Column minute_column(const char* name, const std::vector<double>& prices,
                     std::int64_t start_utc_s) {
  const auto is_sentinel = [](double price) {
    return std::ranges::find(kSentinels, price) != kSentinels.end();
  };
  return with_statistics({name, prices, start_utc_s, 60, "minute", -kUnusualPriceMaxEurPerMwh,
                          kUnusualPriceMaxEurPerMwh, is_sentinel});
}

constexpr std::size_t kDayOfPrices = 96;
constexpr std::size_t kSharedMin = 80 * kDayOfPrices;  ///< fewer may mislead
constexpr double kCorrelationMore = 0.02;              ///< of a shift
/// Limits of the coupled auction, raised in steps when reached (harmonised clearing prices).
constexpr double kAuctionMinEurPerMwh = -500, kAuctionMaxEurPerMwh = 5'000;

/// Whether the day [from, from + 96) repeats the previous day's prices; constant days do not count.
bool repeats_day_before(const DayAheadSeries& series, std::size_t from) {
  bool moves = false;
  for (std::size_t q = from; q < from + kDayOfPrices; ++q) {
    const double price = series.eur_per_mwh[q];
    if (!(price == series.eur_per_mwh[q - kDayOfPrices])) return false;  // a price is missing
    moves = moves || price != series.eur_per_mwh[from];
  }
  return moves;
}

void check_days(const DayAheadSeries& series, const Column& column, Findings& findings) {
  const std::vector<IncompleteDay> incomplete = incomplete_days(series);
  if (!incomplete.empty()) {
    const IncompleteDay& day = incomplete.front();
    findings.warning("gaps", series.start_utc_s,
                     "{} with fewer day-ahead prices than quarter-hours, first {}: {} of {}",
                     counted(incomplete.size(), "day"), day.date, day.prices, day.quarter_hours);
  }
  const std::int64_t into_day_s =
      series.start_utc_s - local_midnight_utc_s(local_date_of(series.start_utc_s));
  const auto before =
      static_cast<std::size_t>((kSecondsPerDay - into_day_s) / kSecondsPerQuarterHour) %
      kDayOfPrices;
  for (std::size_t q = before + kDayOfPrices; q + kDayOfPrices <= series.size(); ++q) {
    const bool midnight = local_minute_of(series.utc_s(q)).minute_of_day == 0;
    if (!midnight || !repeats_day_before(series, q)) continue;
    return findings.error("repeated-day", column, q,
                          "the day-ahead prices of {} are those of the previous day: an old "
                          "answer? download the day again",
                          format_local_date(local_date_of(series.utc_s(q))));
  }
}

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

bool holds_time(std::string_view line, std::int64_t utc_s) {
  const char separator = line.find(';') == line.npos ? ',' : ';';
  CsvFields fields(line, separator);
  for (std::string_view field; fields.take(field);) {
    std::int64_t time_s = 0;
    if (parse_utc(field, time_s, kAlsoBlank) && time_s == utc_s) return true;
  }
  return false;
}

/// "prices.csv:17", or name and time if no row is found: JSON and XML have none.
std::string place_of(const Finding& finding, const std::vector<PriceText>& texts) {
  if (!finding.utc_s) return texts.front().name;
  const std::int64_t quarter_hour_s =
      *finding.utc_s - *finding.utc_s % kSecondsPerQuarterHour;  // for downloads of settled prices
  for (const std::int64_t utc_s : {*finding.utc_s, quarter_hour_s}) {
    for (const PriceText& text : texts) {
      const std::size_t row = row_of_time(text.text, utc_s);
      if (row != 0) return fmt::format("{}:{}", text.name, row);
    }
  }
  return fmt::format("{}: {}", texts.front().name, utc_text(*finding.utc_s).view());
}

}  // namespace

std::vector<Finding> implausible(const MinuteSeries& series) {
  if (series.size() == 0) return {};
  const Column settled = minute_column("settled", series.settled, series.start_utc_s);
  const Column indicative = minute_column("indicative", series.indicative, series.start_utc_s);
  Findings findings;
  const auto check_both = [&](Check check) {
    check(settled, findings);
    check(indicative, findings);
  };
  check_dates(settled, findings);
  for (const Check check : {check_row_step, check_constant, check_sentinels,
                            check_frequent_sentinels, check_unit, check_range, check_unusual}) {
    check_both(check);
  }
  check_settled_changes(series, settled, findings);
  check_both(check_frozen);
  check_copied(settled, indicative, findings);
  check_both(check_gaps);
  return std::move(findings.all);
}

std::vector<Finding> implausible_end(std::string_view text, const MinuteSeries& series) {
  if (text.empty() || text.ends_with('\n') || series.size() == 0) return {};
  const std::size_t last = series.size() - 1;
  const bool first_of_quarter_hour = series.utc_s(last) % kSecondsPerQuarterHour == 0;
  const bool contradicts = last > 0 && !first_of_quarter_hour &&
                           is_published(series.settled[last - 1]) &&
                           !(series.settled[last] == series.settled[last - 1]);
  return {{"cut-end", contradicts,
           "the last row does not end with a line end: file cut off? download it again, or "
           "delete the row",
           series.utc_s(last)}};
}

std::vector<Finding> implausible_day_ahead(const DayAheadSeries& series) {
  if (series.size() == 0) return {};
  const Column column = with_statistics(
      {"day-ahead", series.eur_per_mwh, series.start_utc_s, kSecondsPerQuarterHour, "quarter-hour",
       kAuctionMinEurPerMwh, kAuctionMaxEurPerMwh, is_day_ahead_sentinel});
  Findings findings;
  for (const Check check :
       {check_dates, check_sentinels, check_range, check_unusual, check_constant, check_unit}) {
    check(column, findings);
  }
  check_days(series, column, findings);
  return std::move(findings.all);
}

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
                     "{:.2f}, as filed {:.2f}): filed under the wrong day? correct the dates",
                     days > 0 ? "later" : "earlier", shifted, as_filed.correlation),
         {}}};
  }
  return {};
}

std::vector<Gap> gaps_in(std::span<const double> values, std::int64_t start_utc_s,
                         std::int64_t step_s) {
  std::vector<Gap> gaps;
  for (std::size_t i = 0; i < values.size(); ++i) {
    if (is_published(values[i])) continue;
    const std::int64_t utc_s = start_utc_s + step_s * static_cast<std::int64_t>(i);
    if (gaps.empty() || gaps.back().until_utc_s != utc_s) gaps.push_back({utc_s, utc_s});
    gaps.back().until_utc_s = utc_s + step_s;
  }
  return gaps;
}

std::int64_t minutes_in(const std::vector<Gap>& gaps) {
  std::int64_t minutes = 0;
  for (const Gap& gap : gaps) minutes += gap.minutes();
  return minutes;
}

std::string describe_gaps(std::string_view what, std::vector<Gap> gaps) {
  if (gaps.empty()) return fmt::format("{}: no gaps\n", what);
  std::string text = fmt::format("{}: {}, {} missing\n", what, counted(gaps.size(), "gap"),
                                 counted(static_cast<std::size_t>(minutes_in(gaps)), "minute"));
  std::stable_sort(gaps.begin(), gaps.end(),
                   [](const Gap& a, const Gap& b) { return a.minutes() > b.minutes(); });
  for (std::size_t i = 0; i < std::min(kGapsListed, gaps.size()); ++i) {
    text += fmt::format("  {} to {}: {}\n", utc_text(gaps[i].from_utc_s).view(),
                        utc_text(gaps[i].until_utc_s).view(),
                        counted(static_cast<std::size_t>(gaps[i].minutes()), "minute"));
  }
  if (gaps.size() > kGapsListed) {
    text += fmt::format("  and {}\n", counted(gaps.size() - kGapsListed, "shorter one"));
  }
  return text;
}

AcceptedFindings::AcceptedFindings(std::string_view list) {
  for (CsvFields fields(list); !list.empty();) {
    std::string_view name;
    if (!fields.take(name)) break;
    if (std::ranges::find(kFindingNames, name) == kFindingNames.end()) {
      fail("--accept: no finding is called \"{}\"; use one or more of {}", one_line(name, 40),
           fmt::join(kFindingNames, ","));
    }
    names_.emplace_back(name);
  }
}

AcceptedFindings AcceptedFindings::all() {
  AcceptedFindings accepted;
  accepted.names_.assign(kFindingNames.begin(), kFindingNames.end());
  return accepted;
}

bool AcceptedFindings::accepts(std::string_view name) const {
  return std::ranges::find(names_, name) != names_.end();
}

void judge(const std::vector<Finding>& findings, const AcceptedFindings& accepted,
           const std::vector<PriceText>& texts) {
  for (const Finding& finding : findings) {
    if (!finding.is_error || accepted.accepts(finding.name)) continue;
    fail("{}: {} (--accept {} if intended)", place_of(finding, texts), finding.what, finding.name);
  }
  for (const Finding& finding : findings) {
    fmt::print(stderr, "bess-train: warning: {}: {} [{}]\n", place_of(finding, texts), finding.what,
               finding.name);
  }
}

std::size_t row_of_time(std::string_view text, std::int64_t utc_s) {
  text = without_byte_order_mark(text);
  for (std::size_t row = 1; !text.empty(); ++row) {
    const std::string_view line = take_line(text);
    if (!line.starts_with('#') && holds_time(line, utc_s)) return row;
  }
  return 0;
}

void judge_minutes(const MinuteSeries& series, const PriceText& text,
                   const AcceptedFindings& accepted) {
  std::vector<Finding> findings = implausible_end(text.text, series);
  for (Finding& finding : implausible(series)) findings.push_back(std::move(finding));
  judge(findings, accepted, {text});
}

MinuteSeries read_judged_minutes(const std::filesystem::path& path,
                                 const AcceptedFindings& accepted) {
  const std::string text = read_file(path);
  MinuteSeries series = parse_minute_csv(text, path.string());
  judge_minutes(series, {path.string(), text}, accepted);
  return series;
}

}  // namespace bess
