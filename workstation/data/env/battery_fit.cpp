#include "workstation/data/env/battery_fit.h"

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <optional>
#include <utility>

#include "shared/battery_keys.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr int kRestsMin = 10;
constexpr int kTaperedMin = 10;        ///< readings within the width
constexpr int kRunsMin = 6;            ///< of each direction
constexpr int kRunCyclesMax = 15;      ///< half an hour
constexpr double kRestingFrac = 0.02;  ///< of the power; less counts as 0 W
constexpr double kTaperShown = 0.02;   ///< minimum share missing at the bound
constexpr double kColdShown = 0.05;    ///< minimum share missing for the whole time
constexpr double kColdRoomFrac = 0.2;  ///< of the SoC window, from each end: free of taper
constexpr int kColdQuarterHoursMax = 72;
constexpr double kSure = 3;  ///< standard errors

/// Interval between two ticks whose orders are known.
struct Interval {
  const LoggedCycle& begin;
  const LoggedCycle& end;
  double before_w;  ///< order before `begin`

  [[nodiscard]] bool goes_on() const { return before_w * begin.ordered_w > 0; }
  /// After a change of order the power is that of the new order for the whole interval.
  [[nodiscard]] double first_w() const {
    return before_w == begin.ordered_w ? begin.power_w : end.power_w;
  }
};

std::vector<Interval> intervals_of(const std::vector<LoggedCycle>& cycles) {
  std::vector<Interval> intervals;
  const auto follows = [](const LoggedCycle& a, const LoggedCycle& b) {
    return b.utc_s - a.utc_s == kSecondsPerStep;
  };
  for (std::size_t i = 1; i + 1 < cycles.size(); ++i) {
    if (!follows(cycles[i - 1], cycles[i]) || !follows(cycles[i], cycles[i + 1])) continue;
    intervals.push_back({cycles[i], cycles[i + 1], cycles[i - 1].ordered_w});
  }
  return intervals;
}

/// Mean of the middle half: excludes readings disturbed by a stop or a late order.
std::optional<Fitted> middle_mean(std::vector<double> values, int least) {
  if (std::ssize(values) < least) return std::nullopt;
  std::ranges::sort(values);
  const std::size_t quarter = values.size() / 4;
  const auto count = static_cast<double>(values.size() - 2 * quarter);
  double sum = 0, squares = 0;
  for (std::size_t i = quarter; i < values.size() - quarter; ++i) sum += values[i];
  const double mean = sum / count;
  for (std::size_t i = quarter; i < values.size() - quarter; ++i) {
    squares += (values[i] - mean) * (values[i] - mean);
  }
  const double rounding_w = 0.5;  // if all readings are equal
  return Fitted{mean, std::max(std::sqrt(squares / (count - 1)), rounding_w) / std::sqrt(count),
                static_cast<int>(values.size())};
}

std::optional<Fitted> standby_of(const std::vector<Interval>& intervals) {
  std::vector<double> rests_w;
  for (const Interval& i : intervals) {
    if (i.before_w == 0 && i.begin.ordered_w == 0) rests_w.push_back(i.end.power_w);
  }
  std::optional<Fitted> found = middle_mean(std::move(rests_w), kRestsMin);
  if (found && found->value <= kSure * found->standard_error) found.reset();
  return found;
}

/// Missing share of full power ordered at mid SoC: power that did not flow, or the cut of the order
/// that the battery reported.
struct MissingPower {
  int quarter_hour;
  double share;
};

std::vector<MissingPower> missing_of(const std::vector<Interval>& intervals,
                                     const BatteryParameters& nameplate, double standby_w) {
  const double room_frac = kColdRoomFrac * (nameplate.soc_max_frac - nameplate.soc_min_frac);
  std::vector<MissingPower> missing;
  for (const Interval& i : intervals) {
    const double ordered_w = i.begin.ordered_w;
    const bool is_full = std::fabs(ordered_w) == nameplate.power_w_max || i.begin.is_cut;
    if (ordered_w == 0 || !is_full || i.before_w != ordered_w) continue;
    const double left_frac = ordered_w > 0 ? nameplate.soc_max_frac - i.end.soc_frac
                                           : i.end.soc_frac - nameplate.soc_min_frac;
    if (left_frac < room_frac) continue;
    const double came_w = std::fabs(i.end.power_w - standby_w);
    missing.push_back({local_minute_of(i.end.utc_s).quarter_hour,
                       std::max(1 - came_w / nameplate.power_w_max, 0.0)});
  }
  return missing;
}

/// Fits one daily time range with a constant missing share: the range that explains most squares.
/// Its uncertainty covers the ranges that explain equally much.
void fit_cold(const std::vector<MissingPower>& missing, BatteryFit& fit) {
  std::array<double, 2 * kQuarterHourCount + 1> sum{}, count{};  // cumulative, over two days
  double squares = 0;
  for (const MissingPower& m : missing) {
    squares += m.share * m.share;
    for (const int day : {0, kQuarterHourCount}) {
      sum[static_cast<std::size_t>(m.quarter_hour + day + 1)] += m.share;
      count[static_cast<std::size_t>(m.quarter_hour + day + 1)] += 1;
    }
  }
  std::partial_sum(sum.begin(), sum.end(), sum.begin());
  std::partial_sum(count.begin(), count.end(), count.begin());
  struct HourRange {
    int from = 0, to = 0;
    double share = 0, count = 0, explained = 0;
  };
  std::vector<HourRange> hour_ranges;
  for (int from = 0; from < kQuarterHourCount; ++from) {
    for (int to = from + 1; to <= from + kColdQuarterHoursMax; ++to) {
      const double inside =
          count[static_cast<std::size_t>(to)] - count[static_cast<std::size_t>(from)];
      if (inside < kTaperedMin) continue;
      const double mean =
          (sum[static_cast<std::size_t>(to)] - sum[static_cast<std::size_t>(from)]) / inside;
      hour_ranges.push_back({from, to, mean, inside, inside * mean * mean});
    }
  }
  if (hour_ranges.empty()) return;
  const HourRange best = *std::ranges::max_element(hour_ranges, {}, &HourRange::explained);
  const double variance = std::max(squares - best.explained, 1e-9) /
                          static_cast<double>(std::max<std::size_t>(missing.size(), 2) - 1);
  const double error = std::sqrt(variance / best.count);
  if (best.share < kColdShown || best.share < kSure * error) return;
  double from_error = 0, to_error = 0;
  for (const HourRange& s : hour_ranges) {
    if (s.explained < best.explained - variance) continue;
    from_error = std::max(from_error, std::abs(s.from - best.from) / 4.0);
    to_error = std::max(to_error, std::abs(s.to - best.to) / 4.0);
  }
  const auto inside = static_cast<int>(best.count);
  const double quarter_hour = 1 / 8.0;  // half of one, at least
  fit["cold_power_share"] = Fitted{1 - best.share, error, inside};
  fit["cold_from_hour"] = Fitted{best.from / 4.0, std::max(from_error, quarter_hour), inside};
  fit["cold_to_hour"] =
      Fitted{best.to % kQuarterHourCount / 4.0, std::max(to_error, quarter_hour), inside};
}

/// Reading at full power: distance from the bound and share delivered.
struct TaperPoint {
  double room_frac;
  double share;
};

struct TaperFit {
  Fitted width, share;
};

/// Shares fall by `1 - room / width` times the share missing at the bound. This is linear for each
/// width; the best width is found by search.
std::optional<TaperFit> fit_taper(const std::vector<TaperPoint>& taper_points) {
  struct WidthFit {
    double width = 0, missing = 0, misfit = INFINITY, weight = 0;
    int inside = 0;
  };
  const auto try_width = [&](double width) {
    WidthFit t{.width = width, .misfit = 0};
    double products = 0;
    for (const TaperPoint& r : taper_points) {
      const double depth = std::max(1 - r.room_frac / width, 0.0);
      t.weight += depth * depth;
      products += depth * (1 - r.share);
      t.inside += depth > 0 ? 1 : 0;
    }
    t.missing = t.weight > 0 ? products / t.weight : 0;
    for (const TaperPoint& r : taper_points) {
      const double depth = std::max(1 - r.room_frac / width, 0.0);
      t.misfit += std::pow(1 - r.share - depth * t.missing, 2);
    }
    return t;
  };
  constexpr double kWidthMin = 0.01, kWidthStep = 0.0005;
  constexpr int kWidths = 1'200;  // to 0.61
  std::vector<WidthFit> fits;
  for (int i = 0; i < kWidths; ++i) fits.push_back(try_width(kWidthMin + kWidthStep * i));
  const WidthFit& best = *std::ranges::min_element(fits, {}, &WidthFit::misfit);
  if (best.inside < kTaperedMin || best.missing < kTaperShown) return std::nullopt;
  const auto count = static_cast<int>(taper_points.size());
  const double variance = std::max(best.misfit, 1e-12) / std::max(count - 2, 1);
  double low = best.width, high = best.width;  // widths within one standard error of the best
  for (const WidthFit& t : fits) {
    if (t.misfit > best.misfit + variance) continue;
    low = std::min(low, t.width);
    high = std::max(high, t.width);
  }
  return TaperFit{{best.width, std::max((high - low) / 2, kWidthStep), best.inside},
                  {1 - best.missing, std::sqrt(variance / best.weight), best.inside}};
}

std::optional<TaperFit> taper_of(const std::vector<Interval>& intervals,
                                 const BatteryParameters& nameplate, double standby_w, int sign,
                                 const ColdHours& cold) {
  std::vector<TaperPoint> taper_points;
  for (const Interval& i : intervals) {
    const double full_w = sign * nameplate.power_w_max;
    if (i.before_w != full_w || i.begin.ordered_w != full_w) continue;
    if (cold.hold(local_minute_of(i.end.utc_s).quarter_hour)) continue;
    const double room_frac = sign > 0 ? nameplate.soc_max_frac - i.end.soc_frac
                                      : i.end.soc_frac - nameplate.soc_min_frac;
    if (room_frac <= 0.001) continue;  // idle at the bound
    taper_points.push_back({room_frac, (i.end.power_w - standby_w) / full_w});
  }
  return taper_points.empty() ? std::nullopt : fit_taper(taper_points);
}

/// Consecutive cycles in one direction: grid-side energy, its square, and energy into the cells.
struct Run {
  double energy_wh = 0;
  double square_wh = 0;  ///< power squared over rated power, integrated
  double stored_wh = 0;
  int cycles = 0;
};

std::vector<Run> runs_of(const std::vector<Interval>& intervals, const BatteryParameters& nameplate,
                         double standby_w, int sign) {
  std::vector<Run> runs;
  Run run;
  const auto end_run = [&] {
    if (run.cycles >= 2) runs.push_back(run);
    run = {};
  };
  for (std::size_t k = 0; k < intervals.size(); ++k) {
    const Interval& i = intervals[k];
    const bool has_gap = k > 0 && intervals[k - 1].end.utc_s != i.end.utc_s - kSecondsPerStep;
    const double first_w = i.first_w() - standby_w, last_w = i.end.power_w - standby_w;
    const bool rests_at_bound = last_w * sign < kRestingFrac * nameplate.power_w_max;
    const bool counts = i.goes_on() && i.begin.ordered_w * sign > 0 && !rests_at_bound;
    if (has_gap || !counts) end_run();
    if (!counts) continue;
    run.energy_wh += (first_w + last_w) / 2 * kHoursPerStep;
    run.square_wh += (first_w * first_w + first_w * last_w + last_w * last_w) / 3 /
                     nameplate.power_w_max * kHoursPerStep;
    run.stored_wh += (i.end.soc_frac - i.begin.soc_frac) * nameplate.capacity_wh;
    if (++run.cycles == kRunCyclesMax) end_run();
  }
  end_run();
  return runs;
}

/// Least squares with standard errors, by columns.
struct Regression {
  Eigen::VectorXd value, standard_error;
};

Regression regression(const Eigen::MatrixXd& x, const Eigen::VectorXd& y) {
  const Eigen::MatrixXd inverse = (x.transpose() * x).inverse();
  const Eigen::VectorXd value = inverse * (x.transpose() * y);
  const double variance = (y - x * value).squaredNorm() /
                          static_cast<double>(std::max<Eigen::Index>(x.rows() - x.cols(), 1));
  return {value, (inverse.diagonal() * variance).cwiseSqrt()};
}

/// stored = eta * bought - square * r, and sold / eta - square * r [battery_model.h].
void fit_efficiency(const std::vector<Run>& charged, const std::vector<Run>& discharged,
                    BatteryFit& fit) {
  if (std::ssize(charged) < kRunsMin || std::ssize(discharged) < kRunsMin) return;
  const auto count = static_cast<Eigen::Index>(charged.size() + discharged.size());
  Eigen::MatrixXd x = Eigen::MatrixXd::Zero(count, 3);
  Eigen::VectorXd y(count);
  Eigen::Index row = 0;
  for (const auto& [runs, column] : {std::pair{&charged, 0}, std::pair{&discharged, 1}}) {
    for (const Run& run : *runs) {
      x(row, column) = run.energy_wh;
      x(row, 2) = -run.square_wh;
      y(row++) = run.stored_wh;
    }
  }
  Regression found = regression(x, y);
  const bool has_loss = found.value(2) > kSure * found.standard_error(2) && found.value(2) > 0.002;
  if (!has_loss) found = regression(x.leftCols(2), y);
  const auto n = static_cast<int>(count);
  if (has_loss) fit["full_power_loss"] = Fitted{found.value(2), found.standard_error(2), n};
  const double inverse = found.value(1);
  fit["charge_efficiency"] = Fitted{found.value(0), found.standard_error(0), n};
  fit["discharge_efficiency"] =
      Fitted{1 / inverse, found.standard_error(1) / (inverse * inverse), n};
  if (found.value(0) > 1.01 || inverse < 0.99 || found.value(0) < 0.5 || inverse > 2) {
    fail(
        "the fitted efficiencies, {:.3f} (charging) and {:.3f} (discharging), are impossible: "
        "[battery] capacity_wh is wrong",
        found.value(0), 1 / inverse);
  }
}

/// Refuses a nameplate in other units, such as kW and MW: the fit would find nothing.
void require_same_battery(const std::vector<LoggedCycle>& cycles,
                          const BatteryParameters& nameplate) {
  double flowed_w = 0, ordered_w = 0;
  for (const LoggedCycle& cycle : cycles) {
    flowed_w = std::max(flowed_w, std::fabs(cycle.power_w));
    ordered_w = std::max(ordered_w, std::fabs(cycle.ordered_w));
  }
  const bool is_smaller = ordered_w > 0 && ordered_w < 0.2 * nameplate.power_w_max;
  if (flowed_w <= 1.3 * nameplate.power_w_max && !is_smaller) return;
  fail(
      "orders up to {:.0f} W and power up to {:.0f} W do not fit [battery] power_w {:g}: pass the "
      "nameplate with --config, including capacity_wh",
      ordered_w, flowed_w, nameplate.power_w_max);
}

}  // namespace

BatteryParameters with_fit(BatteryParameters battery, const BatteryFit& fit) {
  for (const BatteryKey& key : kBatteryKeys) {
    const auto found = fit.find(key.name);
    if (found != fit.end()) key.of(battery) = found->second.value;
  }
  battery.charge_efficiency = std::min(battery.charge_efficiency, 1.0);
  battery.discharge_efficiency = std::min(battery.discharge_efficiency, 1.0);
  return battery;
}

BatteryFit fit_battery(const std::vector<LoggedCycle>& cycles, const BatteryParameters& nameplate) {
  require_same_battery(cycles, nameplate);
  const std::vector<Interval> intervals = intervals_of(cycles);
  BatteryFit fit;
  const std::optional<Fitted> standby = standby_of(intervals);
  if (standby) fit["standby_w"] = *standby;
  const double standby_w = standby ? standby->value : 0;
  fit_cold(missing_of(intervals, nameplate, standby_w), fit);
  const ColdHours cold = with_fit(nameplate, fit).cold;
  if (const auto taper = taper_of(intervals, nameplate, standby_w, 1, cold)) {
    fit["charge_taper_width"] = taper->width;
    fit["charge_taper_share"] = taper->share;
  }
  if (const auto taper = taper_of(intervals, nameplate, standby_w, -1, cold)) {
    fit["discharge_taper_width"] = taper->width;
    fit["discharge_taper_share"] = taper->share;
  }
  fit_efficiency(runs_of(intervals, nameplate, standby_w, 1),
                 runs_of(intervals, nameplate, standby_w, -1), fit);
  return fit;
}

}  // namespace bess
