#include "workstation/data/market/model/simulated_market.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "workstation/base/random.h"
#include "workstation/data/market/model/market_parameters.h"
#include "workstation/data/market/series/imbalance_price.h"

namespace bess {

namespace {

// Random processes of the simulated market: three scores per quarter-hour, whose ranks select
// ladder values. A score is an expectation from the calendar plus autoregressive noise.

/// Calendar inputs of a quarter-hour, in the market's local time.
struct MarketCalendar {
  double hour;    ///< 0..24
  double winter;  ///< 1 in mid January, -1 in mid July
  bool weekend;
};

double profile_at(const HourlyProfile& profile, double hour) {
  const double position = hour - 0.5 < 0 ? hour + 23.5 : hour - 0.5;
  const auto before = static_cast<std::size_t>(position);
  const double weight = position - static_cast<double>(before);
  return (1 - weight) * profile[before % 24] + weight * profile[(before + 1) % 24];
}

double expected_score(const ScoreParameters& parameters, const MarketCalendar& calendar) {
  const bool midday = calendar.hour >= 11 && calendar.hour < 15;
  return profile_at(parameters.profile, calendar.hour) + parameters.winter * calendar.winter +
         (midday ? parameters.midday * (1 - calendar.winter) / 2 : 0) +
         (calendar.weekend ? parameters.weekend : 0);
}

MarketCalendar market_calendar_of(std::int64_t utc_s) {
  const LocalMinute local = local_minute_of(utc_s);
  const std::int64_t day =
      utc_from_civil({local.year, local.month, local.day, 0, 0, 0}) / kSecondsPerDay;
  const std::int64_t new_year = utc_from_civil({local.year, 1, 1, 0, 0, 0}) / kSecondsPerDay;
  const double day_of_year = static_cast<double>(day - new_year) + 1;
  const std::int64_t weekday =
      ((day + 3) % 7 + 7) % 7;  // 1 January 1970 was a Thursday; Monday = 0
  return {.hour = local.minute_of_day / 60.0,
          .winter = std::cos(2 * std::numbers::pi * (day_of_year - 15) / 365),
          .weekend = weekday >= 5};
}

class ScoreProcess {
 public:
  explicit ScoreProcess(const ScoreParameters& parameters)
      : parameters_(parameters),
        parts_{UnitAutoregression(parameters.autoregressions[0].correlation),
               UnitAutoregression(parameters.autoregressions[1].correlation),
               UnitAutoregression(parameters.autoregressions[2].correlation)} {}

  /// Score of the next quarter-hour.
  double next(const MarketCalendar& calendar, Random& random) {
    double noise = 0;
    for (std::size_t i = 0; i < parts_.size(); ++i) {
      noise += std::sqrt(parameters_.autoregressions[i].share) * parts_[i].next(random);
    }
    return expected_score(parameters_, calendar) + parameters_.deviation * noise;
  }

 private:
  const ScoreParameters& parameters_;
  std::array<UnitAutoregression, 3> parts_;
};

/// Median |SI| of the 13,650 quarter-hours of ods047, 1 January to 23 May 2023; below alpha's 150
/// MW.
constexpr double kTypicalImbalance_mw = 92;
constexpr std::size_t kQuarterHoursBack = 96;

/// Median price of up to one day ending with quarter-hour `index`.
double recent_median(const std::vector<QuarterHour>& quarter_hours, std::size_t index) {
  std::vector<double> prices;
  const std::size_t first = index + 1 > kQuarterHoursBack ? index + 1 - kQuarterHoursBack : 0;
  for (std::size_t i = first; i <= index; ++i) {
    const double price = quarter_hours[i].price_eur_per_mwh;
    if (is_published(price)) prices.push_back(price);
  }
  const auto middle = prices.begin() + static_cast<std::ptrdiff_t>(prices.size() / 2);
  std::nth_element(prices.begin(), middle, prices.end());
  return *middle;
}

/// Windows of the auction's forecast: adjacent hours and the day around them, on both sides.
constexpr std::size_t kNearHours = 3, kDayHours = 12;
constexpr double kNearForeseen = 0.12, kDayForeseen = 0.26;  ///< a, b
constexpr double kNoiseDeviation = 31;                       ///< EUR/MWh
constexpr double kNoiseShareOfDays = 0.6;  ///< share of the noise variance that persists for days
constexpr double kDaysCorrelation = 0.992, kHoursCorrelation = 0.86;  ///< from hour to hour
/// Mean of Belgium's day-ahead prices by local hour, May 2024 to June 2025, less their mean of 82.
constexpr std::array<double, 24> kProfile{9,   4,   -2,  -7,  -9,  -9,  -3, 9,  18, 12, -3, -17,
                                          -28, -36, -42, -40, -30, -13, 9,  29, 42, 40, 28, 17};
constexpr double kMean = 112;         ///< below the settled prices', as in Belgium
constexpr double kSettledMean = 118;  ///< of the simulated market, about

double mean_around(const std::vector<double>& hours, std::size_t h, std::size_t reach) {
  const std::size_t first = h < reach ? 0 : h - reach;
  const std::size_t end = std::min(hours.size(), h + reach + 1);
  double sum = 0;
  for (std::size_t k = first; k < end; ++k) sum += hours[k];
  return sum / static_cast<double>(end - first);
}

constexpr std::int64_t kQuarterHoursPerYear = 365 * 96;

double climb_ladder(std::span<const LadderStep> ladder, double probability) {
  const auto above = std::upper_bound(
      ladder.begin(), ladder.end(), probability,
      [](double wanted, const LadderStep& step) { return wanted < step.probability; });
  if (above == ladder.begin()) return ladder.front().value;
  if (above == ladder.end()) return ladder.back().value;
  const LadderStep& below = *(above - 1);
  const double weight =
      (probability - below.probability) / (above->probability - below.probability);
  return below.value + weight * (above->value - below.value);
}

/// Rank of a score among `references` as a probability, then its ladder value.
class RankedLadder {
 public:
  RankedLadder(std::span<const LadderStep> ladder, std::vector<double> references)
      : ladder_(ladder), references_(std::move(references)) {
    std::sort(references_.begin(), references_.end());
  }
  double operator()(double score) const {
    const auto below = std::lower_bound(references_.begin(), references_.end(), score);
    const auto rank = static_cast<double>(below - references_.begin()) + 0.5;
    return climb_ladder(ladder_, rank / static_cast<double>(references_.size()));
  }

 private:
  std::span<const LadderStep> ladder_;
  std::vector<double> references_;
};

double pull_of(const ImbalancePull& pull, double now_mw, double before_mw) {
  const auto hinge = [](double value_mw) { return std::max(0.0, value_mw) / kImbalanceUnitMw; };
  return pull.shortage_now * hinge(-now_mw) + pull.shortage_before * hinge(-before_mw) +
         pull.surplus_now * hinge(now_mw) + pull.surplus_before * hinge(before_mw);
}

/// Simulates whole years, which ranks require; the caller selects the period.
class YearSimulator {
 public:
  explicit YearSimulator(std::uint64_t seed) : random_(seed) {}

  std::vector<QuarterHour> next_year(std::int64_t start_utc_s) {
    std::vector<QuarterHour> year(kQuarterHoursPerYear);
    for (std::size_t q = 0; q < year.size(); ++q) {
      year[q].utc_s = start_utc_s + static_cast<std::int64_t>(q) * kSecondsPerQuarterHour;
    }
    Scores scores = draw_scores(start_utc_s);
    set_imbalances(year, scores.imbalance);
    set_marginal_prices(year, scores);
    settle(year);
    return year;
  }

 private:
  struct Scores {
    std::vector<double> imbalance, incremental, decremental;
  };

  Scores draw_scores(std::int64_t start_utc_s) {
    Scores scores;
    for (std::int64_t q = 0; q < kQuarterHoursPerYear; ++q) {
      const MarketCalendar calendar = market_calendar_of(start_utc_s + q * kSecondsPerQuarterHour);
      scores.imbalance.push_back(imbalance_.next(calendar, random_));
      scores.incremental.push_back(incremental_.next(calendar, random_));
      scores.decremental.push_back(decremental_.next(calendar, random_));
    }
    return scores;
  }

  void set_imbalances(std::vector<QuarterHour>& year, const std::vector<double>& scores) const {
    const RankedLadder imbalance_mw(kImbalanceLadder, scores);
    for (std::size_t q = 0; q < year.size(); ++q) {
      year[q].system_imbalance_mw = imbalance_mw(scores[q]);
    }
  }

  /// The ladders apply to the active side, so ranks are taken among its quarter-hours.
  void set_marginal_prices(std::vector<QuarterHour>& year, Scores& scores) const {
    std::vector<double> active_incremental;
    std::vector<double> active_decremental;
    double before_mw = last_imbalance_mw_;
    for (std::size_t q = 0; q < year.size(); ++q) {
      const double now_mw = year[q].system_imbalance_mw;
      scores.incremental[q] += pull_of(kIncrementalPull, now_mw, before_mw);
      scores.decremental[q] += pull_of(kDecrementalPull, now_mw, before_mw);
      if (is_short(now_mw)) {
        active_incremental.push_back(scores.incremental[q]);
      } else {
        active_decremental.push_back(scores.decremental[q]);
      }
      before_mw = now_mw;
    }
    const RankedLadder incremental(kIncrementalLadder, std::move(active_incremental));
    const RankedLadder decremental(kDecrementalLadder, std::move(active_decremental));
    for (std::size_t q = 0; q < year.size(); ++q) {
      year[q].marginal_incremental_eur_per_mwh = incremental(scores.incremental[q]);
      year[q].marginal_decremental_eur_per_mwh = decremental(scores.decremental[q]);
    }
  }

  void settle(std::vector<QuarterHour>& year) {
    for (QuarterHour& quarter_hour : year) {
      const ImbalanceState state{quarter_hour.system_imbalance_mw, last_imbalance_mw_,
                                 quarter_hour.marginal_incremental_eur_per_mwh,
                                 quarter_hour.marginal_decremental_eur_per_mwh};
      quarter_hour.alpha_eur_per_mwh = alpha_eur_per_mwh(state);
      quarter_hour.price_eur_per_mwh = in_cents(imbalance_price_eur_per_mwh(state));
      last_imbalance_mw_ = quarter_hour.system_imbalance_mw;
    }
  }

  Random random_;
  ScoreProcess imbalance_{kImbalanceScore};
  ScoreProcess incremental_{kIncrementalScore};
  ScoreProcess decremental_{kDecrementalScore};
  double last_imbalance_mw_ = 0;  ///< of the previous year
};

}  // namespace

std::size_t infer_missing_imbalances(std::vector<QuarterHour>& quarter_hours) {
  std::size_t filled = 0;
  for (std::size_t i = 0; i < quarter_hours.size(); ++i) {
    QuarterHour& row = quarter_hours[i];
    if (is_published(row.system_imbalance_mw) || !is_published(row.price_eur_per_mwh)) continue;
    const bool shortage = row.price_eur_per_mwh > recent_median(quarter_hours, i);
    row.system_imbalance_mw = shortage ? -kTypicalImbalance_mw : kTypicalImbalance_mw;
    ++filled;
  }
  return filled;
}

MinuteSeries minutes_on_quarter_hours(const std::vector<QuarterHour>& quarter_hours,
                                      std::uint64_t seed) {
  MinuteSeries series;
  series.start_utc_s = quarter_hours.front().utc_s;
  const std::int64_t span_s =
      quarter_hours.back().utc_s - series.start_utc_s + kSecondsPerQuarterHour;
  series.indicative.assign(static_cast<std::size_t>(span_s / 60), kNotPublished);
  series.settled = series.indicative;
  MinutePathGenerator generator(seed);
  for (const QuarterHour& quarter_hour : quarter_hours) {
    if (!is_published(quarter_hour.price_eur_per_mwh)) continue;
    const auto first = static_cast<std::ptrdiff_t>((quarter_hour.utc_s - series.start_utc_s) / 60);
    std::fill_n(series.settled.begin() + first, kMinutesPerQuarterHour,
                quarter_hour.price_eur_per_mwh);
    if (!is_published(quarter_hour.system_imbalance_mw)) continue;
    MinutePrices prices = generator.next(quarter_hour);
    std::transform(prices.begin(), prices.end() - 1, prices.begin(), in_cents);
    std::copy(prices.begin(), prices.end(), series.indicative.begin() + first);
  }
  return series;
}

DayAheadSeries simulate_day_ahead(const std::vector<QuarterHour>& quarter_hours,
                                  std::uint64_t seed) {
  std::vector<double> hours;
  for (std::size_t q = 0; q + 4 <= quarter_hours.size(); q += 4) {
    double sum = 0;
    for (std::size_t k = q; k < q + 4; ++k) sum += quarter_hours[k].price_eur_per_mwh;
    hours.push_back(sum / 4);
  }
  Random random(seed);
  double days = random.normal(), within = random.normal();
  DayAheadSeries series;
  for (std::size_t h = 0; h < hours.size(); ++h) {
    days = kDaysCorrelation * days +
           std::sqrt(1 - kDaysCorrelation * kDaysCorrelation) * random.normal();
    within = kHoursCorrelation * within +
             std::sqrt(1 - kHoursCorrelation * kHoursCorrelation) * random.normal();
    const double noise =
        std::sqrt(kNoiseShareOfDays) * days + std::sqrt(1 - kNoiseShareOfDays) * within;
    const std::int64_t utc_s = quarter_hours[4 * h].utc_s;
    const auto hour = static_cast<std::size_t>(local_minute_of(utc_s).minute_of_day / 60);
    const double foreseen = kNearForeseen * (mean_around(hours, h, kNearHours) - kSettledMean) +
                            kDayForeseen * (mean_around(hours, h, kDayHours) - kSettledMean);
    const double price = in_cents(kMean + kProfile[hour] + foreseen + kNoiseDeviation * noise);
    for (int q = 0; q < 4; ++q) {
      append_day_ahead(series, {utc_s + q * kSecondsPerQuarterHour, price, 60, 0});
    }
  }
  return series;
}

std::vector<QuarterHour> simulate_quarter_hours(const UtcSpan& period, std::uint64_t seed) {
  YearSimulator simulator(seed);
  std::vector<QuarterHour> quarter_hours;
  std::int64_t utc_s = period.from_s;
  while (utc_s < period.until_s) {
    const std::vector<QuarterHour> year = simulator.next_year(utc_s);
    quarter_hours.insert(quarter_hours.end(), year.begin(), year.end());
    utc_s += kQuarterHoursPerYear * kSecondsPerQuarterHour;
  }
  quarter_hours.resize(
      static_cast<std::size_t>((period.until_s - period.from_s) / kSecondsPerQuarterHour));
  return quarter_hours;
}

double UnitAutoregression::next(Random& random) {
  const double shock = random.normal();
  value_ = started_ ? correlation_ * value_ + std::sqrt(1 - correlation_ * correlation_) * shock
                    : shock;  // starts in the stationary distribution: no warm-up days
  started_ = true;
  return value_;
}

MinutePathGenerator::MinutePathGenerator(std::uint64_t seed)
    : random_(seed), deviation_(kMinutePath.imbalance_correlation) {}

MinutePathGenerator::Path MinutePathGenerator::imbalance_path(double mean_mw) {
  Path instantaneous{};
  for (double& value : instantaneous) {
    value = kMinutePath.imbalance_deviation_mw * deviation_.next(random_);
  }
  const double mean =
      std::accumulate(instantaneous.begin(), instantaneous.end(), 0.0) / kMinutesPerQuarterHour;
  Path running{};
  double sum_mw = 0;
  for (int m = 0; m < kMinutesPerQuarterHour; ++m) {
    sum_mw += instantaneous[m] + mean_mw - mean;
    running[m] = sum_mw / (m + 1);
  }
  running.back() = mean_mw;  // rounding must not move a mean of 0 to the other side
  return running;
}

/// Monotone path to `final`: upwards for direction +1, downwards for -1. It starts at the previous
/// quarter-hour's price if that is on the path, else at a random gap from the end.
MinutePathGenerator::Path MinutePathGenerator::staircase(double previous, double final,
                                                         double direction) {
  const double gap_drawn = -kMinutePath.first_bid_gap_eur_per_mwh * std::log(1 - random_.uniform());
  const double gap = std::max((final - previous) * direction, gap_drawn) * direction;
  const double lateness = std::sqrt(std::sqrt(random_.uniform()));
  const int reached = static_cast<int>(kMinutePath.reach_minutes * lateness);
  Path path{};
  path.fill(final);
  double left = 1;  // remaining share of the gap
  for (int m = 0; m < reached; ++m) {
    path[m] = final - gap * left;
    if (random_.uniform() < kMinutePath.step_probability) left *= random_.uniform();
  }
  return path;
}

MinutePathGenerator::Sides MinutePathGenerator::final_sides(const QuarterHour& quarter_hour) const {
  Sides sides = previous_sides_;
  const double incremental = quarter_hour.marginal_incremental_eur_per_mwh;
  const double decremental = quarter_hour.marginal_decremental_eur_per_mwh;
  // A settled price without marginal prices is the marginal price of the active side.
  const bool shortage = is_short(quarter_hour.system_imbalance_mw);
  double& active = shortage ? sides.incremental : sides.decremental;
  active = quarter_hour.price_eur_per_mwh;
  if (is_published(incremental)) sides.incremental = incremental;
  if (is_published(decremental)) sides.decremental = decremental;
  return sides;
}

MinutePath MinutePathGenerator::draw(const QuarterHour& quarter_hour) {
  const double settled = quarter_hour.price_eur_per_mwh;
  const Sides sides = final_sides(quarter_hour);
  const Path imbalance = imbalance_path(quarter_hour.system_imbalance_mw);
  const Path incremental = staircase(previous_sides_.incremental, sides.incremental, +1);
  const Path decremental = staircase(previous_sides_.decremental, sides.decremental, -1);
  // Final difference to the formula: dead band and alpha' since 2024. Differences below a cent are
  // rounding.
  const double by_formula = imbalance_price_eur_per_mwh(
      {imbalance.back(), previous_imbalance_mw_, incremental.back(), decremental.back()});
  const double unexplained = in_cents(by_formula) == settled ? 0 : settled - by_formula;
  const MinutePath path{imbalance, incremental, decremental, previous_imbalance_mw_, unexplained};
  previous_sides_ = sides;
  previous_imbalance_mw_ = quarter_hour.system_imbalance_mw;
  return path;
}

MinutePrices MinutePathGenerator::next(const QuarterHour& quarter_hour) {
  const MinutePath path = draw(quarter_hour);
  MinutePrices prices{};
  for (int m = 0; m < kMinutesPerQuarterHour; ++m) {
    prices[m] = imbalance_price_eur_per_mwh(
        {path.imbalance_mw[m], m == 0 ? 0 : path.previous_imbalance_mw,
         path.incremental_eur_per_mwh[m], path.decremental_eur_per_mwh[m]});
    if (is_short(path.imbalance_mw[m]) == is_short(quarter_hour.system_imbalance_mw)) {
      prices[m] += path.unexplained_eur_per_mwh;
    }
  }
  prices.back() = quarter_hour.price_eur_per_mwh;
  return prices;
}

}  // namespace bess
