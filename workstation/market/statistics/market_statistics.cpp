#include "workstation/market/statistics/market_statistics.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shared/local_time.h"
#include "workstation/market/series/imbalance_price.h"

namespace bess {
namespace {

/// Pearson correlation of a series with itself `lag` places later; pairs with an unknown are left
/// out.
double autocorrelation_at(std::span<const double> values, std::size_t lag) {
  double count = 0, sum_a = 0, sum_b = 0, sum_aa = 0, sum_bb = 0, sum_ab = 0;
  for (std::size_t i = 0; i + lag < values.size(); ++i) {
    const double a = values[i];
    const double b = values[i + lag];
    if (!is_published(a) || !is_published(b)) continue;
    ++count, sum_a += a, sum_b += b, sum_aa += a * a, sum_bb += b * b, sum_ab += a * b;
  }
  if (count < 2) return kNotPublished;
  const double covariance = sum_ab - sum_a * sum_b / count;
  const double variances = (sum_aa - sum_a * sum_a / count) * (sum_bb - sum_b * sum_b / count);
  return variances > 0 ? covariance / std::sqrt(variances) : kNotPublished;
}

template <typename Predicate>
double share_of(std::span<const double> values, Predicate predicate) {
  const auto hits = std::count_if(values.begin(), values.end(), predicate);
  return static_cast<double>(hits) / static_cast<double>(values.size());
}

std::vector<double> sorted_published(std::span<const double> values) {
  std::vector<double> sorted;
  std::copy_if(values.begin(), values.end(), std::back_inserter(sorted), is_published);
  std::sort(sorted.begin(), sorted.end());
  return sorted;
}

/// Days of 92 or 100 quarter-hours inside [from, until).
std::vector<ClockChange> clock_changes_between(std::int64_t from_utc_s, std::int64_t until_utc_s) {
  std::vector<ClockChange> changes;
  std::int64_t midnight_utc_s = -1;
  for (std::int64_t utc_s = from_utc_s - from_utc_s % 3600; utc_s <= until_utc_s; utc_s += 3600) {
    if (local_minute_of(utc_s).minute_of_day != 0 || utc_s < from_utc_s) continue;
    const std::int64_t quarter_hours = (utc_s - midnight_utc_s) / kSecondsPerQuarterHour;
    if (midnight_utc_s >= 0 && quarter_hours != kQuarterHourCount) {
      const LocalMinute day = local_minute_of(midnight_utc_s);
      changes.push_back({day.year, day.month, day.day, static_cast<int>(quarter_hours)});
    }
    midnight_utc_s = utc_s;
  }
  return changes;
}

/// `settled` by quarter-hour of the UTC grid, from the one that holds `from_utc_s`.
std::vector<RegimeStatistics> regime_statistics(std::span<const double> settled,
                                                std::int64_t from_utc_s) {
  const std::int64_t first = from_utc_s / kSecondsPerQuarterHour;
  const auto count = static_cast<std::int64_t>(settled.size());
  std::vector<RegimeStatistics> rows;
  auto end = settled.begin();
  for (const PriceRegime* regime :
       regimes_met({from_utc_s, (first + count) * kSecondsPerQuarterHour})) {
    const PriceRegime* const next = regime + 1;
    const bool is_last = next == std::to_address(price_regimes().end());
    const auto begin = end;
    end = is_last ? settled.end()
                  : settled.begin() +
                        std::min(count, next->from_utc_s / kSecondsPerQuarterHour - first);
    rows.push_back({regime, price_statistics({begin, end})});
  }
  return rows;
}

/// How often two neighbours lie on different sides of zero.
struct FlipCount {
  std::size_t pairs = 0, flips = 0;
  void add(bool before, bool after) {
    ++pairs;
    if (before != after) ++flips;
  }
  [[nodiscard]] double rate() const {
    return pairs > 0 ? static_cast<double>(flips) / static_cast<double>(pairs) : 0;
  }
};

}  // namespace

double quantile_of_sorted(std::span<const double> sorted, double probability) {
  const double position = probability * static_cast<double>(sorted.size() - 1);
  const auto below = static_cast<std::size_t>(position);
  const std::size_t above = std::min(below + 1, sorted.size() - 1);
  return sorted[below] + (position - static_cast<double>(below)) * (sorted[above] - sorted[below]);
}

PriceStatistics price_statistics(std::span<const double> settled) {
  const std::vector<double> sorted = sorted_published(settled);
  PriceStatistics result{.count = sorted.size()};
  if (sorted.empty()) return result;
  result.mean =
      std::accumulate(sorted.begin(), sorted.end(), 0.0) / static_cast<double>(sorted.size());
  result.minimum = sorted.front();
  result.quartile_1 = quantile_of_sorted(sorted, 0.25);
  result.median = quantile_of_sorted(sorted, 0.5);
  result.quartile_3 = quantile_of_sorted(sorted, 0.75);
  result.maximum = sorted.back();
  result.share_below_minus_200 = share_of(sorted, [](double price) { return price < -200; });
  result.share_below_0 = share_of(sorted, [](double price) { return price < 0; });
  result.share_above_1000 = share_of(sorted, [](double price) { return price > 1000; });
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    result.autocorrelation[i] =
        autocorrelation_at(settled, static_cast<std::size_t>(kAutocorrelationLags[i]));
  }
  FlipCount flips;
  for (std::size_t q = 1; q < settled.size(); ++q) {
    if (!is_published(settled[q - 1]) || !is_published(settled[q])) continue;
    flips.add(settled[q - 1] < 0, settled[q] < 0);
  }
  result.sign_flip_rate = flips.rate();
  return result;
}

std::vector<double> settled_by_quarter_hour(const MinuteSeries& series) {
  const std::int64_t first = series.start_utc_s / kSecondsPerQuarterHour;
  std::vector<double> settled;
  for (std::size_t m = 0; m < series.size(); ++m) {
    const auto q = static_cast<std::size_t>(series.utc_s(m) / kSecondsPerQuarterHour - first);
    if (q >= settled.size()) settled.resize(q + 1, kNotPublished);
    if (is_published(series.settled[m])) settled[q] = series.settled[m];
  }
  return settled;
}

ConvergenceByMinute convergence_by_minute(const MinuteSeries& series) {
  std::array<std::vector<double>, kMinutesPerQuarterHour> errors;
  for (std::size_t m = 0; m < series.size(); ++m) {
    const double error = std::abs(series.indicative[m] - series.settled[m]);
    const auto minute_of_quarter_hour =
        static_cast<std::size_t>(series.utc_s(m) % kSecondsPerQuarterHour / 60);
    if (is_published(error)) errors[minute_of_quarter_hour].push_back(error);
  }
  ConvergenceByMinute result{};
  for (std::size_t minute_of_quarter_hour = 0; minute_of_quarter_hour < errors.size();
       ++minute_of_quarter_hour) {
    std::vector<double>& of_minute = errors[minute_of_quarter_hour];
    if (of_minute.empty()) continue;
    std::sort(of_minute.begin(), of_minute.end());
    result[minute_of_quarter_hour] = {
        .count = of_minute.size(),
        .median_error = quantile_of_sorted(of_minute, 0.5),
        .mean_error = std::accumulate(of_minute.begin(), of_minute.end(), 0.0) /
                      static_cast<double>(of_minute.size())};
  }
  return result;
}

double imbalance_sign_flip_rate(const std::vector<QuarterHour>& quarter_hours) {
  FlipCount count;
  for (std::size_t i = 1; i < quarter_hours.size(); ++i) {
    const QuarterHour& before = quarter_hours[i - 1];
    const QuarterHour& after = quarter_hours[i];
    if (after.utc_s - before.utc_s != kSecondsPerQuarterHour ||
        !is_published(before.system_imbalance_mw) || !is_published(after.system_imbalance_mw)) {
      continue;
    }
    count.add(is_short(before.system_imbalance_mw), is_short(after.system_imbalance_mw));
  }
  return count.pairs > 0 ? count.rate() : kNotPublished;
}

MarketStatistics statistics_of_minutes(const MinuteSeries& series) {
  MarketStatistics result;
  result.from_utc_s = series.start_utc_s;
  result.until_utc_s = series.utc_s(series.size());
  const std::vector<double> settled = settled_by_quarter_hour(series);
  result.price = price_statistics(settled);
  result.regimes = regime_statistics(settled, result.from_utc_s);
  result.convergence = convergence_by_minute(series);
  result.settled_gaps = gaps_in(series.settled, series.start_utc_s, 60);
  result.indicative_gaps = gaps_in(series.indicative, series.start_utc_s, 60);
  result.clock_changes = clock_changes_between(result.from_utc_s, result.until_utc_s);
  return result;
}

MarketStatistics statistics_of_quarter_hours(const std::vector<QuarterHour>& quarter_hours) {
  MarketStatistics result;
  result.from_utc_s = quarter_hours.front().utc_s;
  result.until_utc_s = quarter_hours.back().utc_s + kSecondsPerQuarterHour;
  std::vector<double> settled(
      static_cast<std::size_t>((result.until_utc_s - result.from_utc_s) / kSecondsPerQuarterHour),
      kNotPublished);
  for (const QuarterHour& quarter_hour : quarter_hours) {
    settled[static_cast<std::size_t>((quarter_hour.utc_s - result.from_utc_s) /
                                     kSecondsPerQuarterHour)] = quarter_hour.price_eur_per_mwh;
  }
  result.price = price_statistics(settled);
  result.regimes = regime_statistics(settled, result.from_utc_s);
  const double flips = imbalance_sign_flip_rate(quarter_hours);
  if (is_published(flips)) result.imbalance_sign_flip_rate = flips;
  result.settled_gaps = gaps_in(settled, result.from_utc_s, kSecondsPerQuarterHour);
  result.clock_changes = clock_changes_between(result.from_utc_s, result.until_utc_s);
  return result;
}

}  // namespace bess
