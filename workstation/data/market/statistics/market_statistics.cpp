#include "workstation/data/market/statistics/market_statistics.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"

namespace bess {

namespace {

/// Pearson correlation of a series with itself `lag` places later, without pairs with unknown
/// values.
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
      changes.push_back({local_date_of(midnight_utc_s), static_cast<int>(quarter_hours)});
    }
    midnight_utc_s = utc_s;
  }
  return changes;
}

/// `settled` by quarter-hour of the UTC grid, from the one that contains `from_utc_s`.
std::vector<RegimeStatistics> regime_statistics(std::span<const double> settled,
                                                std::int64_t from_utc_s) {
  const std::int64_t first = from_utc_s / kSecondsPerQuarterHour;
  const auto count = static_cast<std::int64_t>(settled.size());
  std::vector<RegimeStatistics> rows;
  auto end = settled.begin();
  for (const PriceRegime* regime :
       regimes_met({from_utc_s, (first + count) * kSecondsPerQuarterHour})) {
    const PriceRegime* const next = regime + 1;
    const bool is_last = next == std::end(kPriceRegimes);
    const auto begin = end;
    end = is_last ? settled.end()
                  : settled.begin() +
                        std::min(count, next->from_utc_s / kSecondsPerQuarterHour - first);
    rows.push_back({regime, price_statistics({begin, end})});
  }
  return rows;
}

/// Number of neighbours on different sides of zero.
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

/// The part that minutes and quarter-hours share; `settled` as for regime_statistics().
MarketStatistics statistics_of(std::int64_t from_utc_s, std::int64_t until_utc_s,
                               std::span<const double> settled) {
  MarketStatistics result;
  result.from_utc_s = from_utc_s;
  result.until_utc_s = until_utc_s;
  result.price = price_statistics(settled);
  result.regimes = regime_statistics(settled, from_utc_s);
  result.clock_changes = clock_changes_between(from_utc_s, until_utc_s);
  return result;
}

std::string format_price_text(std::string_view what, const PriceStatistics& price) {
  std::string text = fmt::format("{}, EUR/MWh, {}\n", what, counted(price.count, "quarter-hour"));
  if (price.count == 0) return text;
  text += fmt::format(
      "  mean {:.2f}  minimum {:.2f}  quartiles {:.2f} / {:.2f} / {:.2f}  maximum {:.2f}\n",
      price.mean, price.minimum, price.quartile_1, price.median, price.quartile_3, price.maximum);
  text += fmt::format("  below -200: {:.2f} %  below 0: {:.2f} %  above 1000: {:.3f} %\n",
                      100 * price.share_below_minus_200, 100 * price.share_below_0,
                      100 * price.share_above_1000);
  text += "  autocorrelation";
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    const double value = price.autocorrelation[i];
    text += fmt::format("  lag {}: {}", kAutocorrelationLags[i],
                        std::isfinite(value) ? fmt::format("{:.2f}", value) : "-");
  }
  return text + fmt::format("\n  changes sign between {:.1f} % of quarter-hours\n",
                            100 * price.sign_flip_rate);
}

std::string format_regimes_text(const std::vector<RegimeStatistics>& regimes) {
  std::string text = fmt::format("{:<52} {:>6} {:>8} {:>25} {:>8} {:>8}\n", "by price regime",
                                 "count", "mean", "quartiles", "< -200", "> 1000");
  for (const auto& [regime, price] : regimes) {
    text += fmt::format("  {:<50} {:>6}", regime->name, price.count);
    text += price.count == 0
                ? "\n"
                : fmt::format(" {:>8.2f} {:>25} {:>6.2f} % {:>6.3f} %\n", price.mean,
                              fmt::format("{:.2f} / {:.2f} / {:.2f}", price.quartile_1,
                                          price.median, price.quartile_3),
                              100 * price.share_below_minus_200, 100 * price.share_above_1000);
  }
  return text;
}

std::string format_convergence_text(const ConvergenceByMinute& convergence) {
  std::string text = "indicative against settled price, absolute error, EUR/MWh\n";
  text += "  minute    rows    median      mean\n";
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    const Convergence& of_minute = convergence[m];
    if (of_minute.count == 0) continue;
    text += fmt::format("  {:6} {:7} {:9.2f} {:9.2f}\n", m, of_minute.count, of_minute.median_error,
                        of_minute.mean_error);
  }
  return text;
}

void add_price(Json& json, const PriceStatistics& price) {
  // Without a price all figures are unknown.
  const auto set = [&](const char* name, double figure) {
    json.set(name, price.count > 0 ? figure : NAN);
  };
  json.set("quarter_hours", price.count);
  set("settled_eur_per_mwh_mean", price.mean);
  set("settled_eur_per_mwh_min", price.minimum);
  set("settled_eur_per_mwh_quartile_1", price.quartile_1);
  set("settled_eur_per_mwh_median", price.median);
  set("settled_eur_per_mwh_quartile_3", price.quartile_3);
  set("settled_eur_per_mwh_max", price.maximum);
  set("share_below_minus_200", price.share_below_minus_200);
  set("share_below_0", price.share_below_0);
  set("share_above_1000", price.share_above_1000);
  set("sign_flip_rate", price.sign_flip_rate);
  Json lags = Json::object();
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    lags.set(std::to_string(kAutocorrelationLags[i]).c_str(),
             price.count > 0 ? price.autocorrelation[i] : NAN);
  }
  json.set("autocorrelation", std::move(lags));
}

Json regimes_json(const std::vector<RegimeStatistics>& regimes) {
  return Json::list_from(regimes, [](const RegimeStatistics& of) {
    Json row = Json::object({{"regime", of.regime->name}});
    add_price(row, of.price);
    return row;
  });
}

Json convergence_json(const ConvergenceByMinute& convergence) {
  Json list = Json::list();
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    const bool known = convergence[m].count > 0;
    const double median = known ? convergence[m].median_error : NAN;
    const double mean = known ? convergence[m].mean_error : NAN;
    list.add(Json::object({{"minute", m},
                           {"rows", convergence[m].count},
                           {"error_eur_per_mwh_median", median},
                           {"error_eur_per_mwh_mean", mean}}));
  }
  return list;
}

void add_span(Json& json, std::int64_t from_utc_s, std::int64_t until_utc_s) {
  json.set("from_utc", utc_text(from_utc_s).view());
  json.set("until_utc", utc_text(until_utc_s).view());
}

Json gaps_json(const std::vector<Gap>& gaps) {
  return Json::list_from(gaps, [](const Gap& gap) {
    Json span = Json::object();
    add_span(span, gap.from_utc_s, gap.until_utc_s);
    return span;
  });
}

Json clock_changes_json(const std::vector<ClockChange>& changes) {
  return Json::list_from(changes, [](const ClockChange& change) {
    return Json::object(
        {{"day", format_local_date(change.day)}, {"quarter_hours", change.quarter_hours}});
  });
}

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
  MarketStatistics result = statistics_of(series.start_utc_s, series.utc_s(series.size()),
                                          settled_by_quarter_hour(series));
  result.convergence = convergence_by_minute(series);
  result.settled_gaps = gaps_in(series.settled, series.start_utc_s, 60);
  result.indicative_gaps = gaps_in(series.indicative, series.start_utc_s, 60);
  return result;
}

MarketStatistics statistics_of_quarter_hours(const std::vector<QuarterHour>& quarter_hours) {
  const std::int64_t from_utc_s = quarter_hours.front().utc_s;
  const auto index_of = [from_utc_s](const QuarterHour& row) {
    return static_cast<std::size_t>((row.utc_s - from_utc_s) / kSecondsPerQuarterHour);
  };
  std::vector<double> settled(index_of(quarter_hours.back()) + 1, kNotPublished);
  for (const QuarterHour& row : quarter_hours) settled[index_of(row)] = row.price_eur_per_mwh;
  MarketStatistics result =
      statistics_of(from_utc_s, quarter_hours.back().utc_s + kSecondsPerQuarterHour, settled);
  const double flips = imbalance_sign_flip_rate(quarter_hours);
  if (is_published(flips)) result.imbalance_sign_flip_rate = flips;
  result.settled_gaps = gaps_in(settled, from_utc_s, kSecondsPerQuarterHour);
  return result;
}

std::string format_statistics_text(const MarketStatistics& statistics, std::string_view what) {
  std::string text = fmt::format("{} to {}\n", utc_text(statistics.from_utc_s).view(),
                                 utc_text(statistics.until_utc_s).view());
  text += format_price_text(what, statistics.price);
  text += format_regimes_text(statistics.regimes);
  if (statistics.imbalance_sign_flip_rate) {
    text += fmt::format("system imbalance changes sides between {:.1f} % of quarter-hours\n",
                        100 * *statistics.imbalance_sign_flip_rate);
  }
  if (statistics.convergence) text += format_convergence_text(*statistics.convergence);
  text += describe_gaps(what, statistics.settled_gaps);
  if (statistics.convergence) text += describe_gaps("indicative price", statistics.indicative_gaps);
  for (const ClockChange& change : statistics.clock_changes) {
    text += fmt::format("clock change: {} has {} quarter-hours\n", format_local_date(change.day),
                        change.quarter_hours);
  }
  return text;
}

std::string format_statistics_json(const MarketStatistics& statistics) {
  Json json = answer("price_statistics");
  add_span(json, statistics.from_utc_s, statistics.until_utc_s);
  add_price(json, statistics.price);
  json.set("regimes", regimes_json(statistics.regimes));
  json.set("imbalance_sign_flip_rate", statistics.imbalance_sign_flip_rate.value_or(NAN));
  json.set("convergence",
           statistics.convergence ? convergence_json(*statistics.convergence) : Json::null());
  json.set("settled_gaps", gaps_json(statistics.settled_gaps));
  json.set("indicative_gaps", gaps_json(statistics.indicative_gaps));
  json.set("clock_changes", clock_changes_json(statistics.clock_changes));
  return json.line();
}

}  // namespace bess
