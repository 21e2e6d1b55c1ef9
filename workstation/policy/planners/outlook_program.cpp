#include "workstation/policy/planners/outlook_program.h"

#include <fmt/format.h>

#include <Eigen/Cholesky>
#include <algorithm>
#include <mutex>
#include <unordered_map>

#include "shared/battery_model.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"
#include "workstation/base/parallel_for.h"

namespace bess {
namespace {

constexpr int kUsualDays = 4;  ///< backward induction after the end of a plan
constexpr std::size_t kRow = std::size_t{DeviationChain::kBins} * OutlookProgram::kSocPoints;
constexpr int kTerms = 4;                             ///< terms of usual(): constant, D, h, L
constexpr std::size_t kKeptMax = 180 * kStepsPerDay;  ///< cached steps, 2 kB each

int quarter_hour_of(std::int64_t utc_s) { return local_minute_of(utc_s).quarter_hour; }

std::int64_t quarter_hour_start(std::int64_t utc_s) {
  return utc_s - utc_s % kSecondsPerQuarterHour;
}

/// Instant for which the observed row was published.
std::int64_t row_utc_s(const MarketStep& step) {
  return step.utc_s - 60 * std::int64_t{step.observed_age_min};
}

/// Starts of the two minutes of a step, which may lie in different quarter-hours.
std::array<std::int64_t, 2> paid_minutes(std::int64_t step_utc_s) {
  return {step_utc_s, step_utc_s + 60};
}

}  // namespace

struct OutlookProgram::ValueCache {
  struct Entry {
    MarketStep step;
    GridPosition position;              ///< without `ahead`
    float ahead_eur[2][2][kSocPoints];  ///< by level and bin
  };
  std::mutex mutex;
  std::unordered_map<std::int64_t, Entry> by_utc_s;

  [[nodiscard]] const Entry* find(const MarketStep& step) const {
    const auto found = by_utc_s.find(step.utc_s);
    return found != by_utc_s.end() && found->second.step == step ? &found->second : nullptr;
  }
  const Entry& add(const MarketStep& step, const GridPosition& position) {
    if (by_utc_s.size() >= kKeptMax) by_utc_s.clear();
    Entry& entry = by_utc_s.insert_or_assign(step.utc_s, Entry{step, position, {}}).first->second;
    for (std::size_t l = 0; l < position.ahead.size(); ++l) {
      if (position.ahead[l] == nullptr) continue;
      std::copy_n(position.ahead[l], 2 * kSocPoints, &entry.ahead_eur[l][0][0]);
      entry.position.ahead[l] = &entry.ahead_eur[l][0][0];
    }
    return entry;
  }
};

OutlookProgram::OutlookProgram(const MarketSteps& market, const std::vector<MarketDay>& days,
                               const BatteryParameters& battery)
    : battery_(battery),
      grid_(battery, kSocPoints),
      recursion_(battery_, grid_, gamma_),
      cache_(std::make_shared<ValueCache>()) {
  require_training_days(days.size());
  fit_means(market, days);
  fit_lasting(market, days);
  fit_coefficients(market, days);
  levels_ = fit_levels(market, days, kLevelCount).levels;
  fit_chain(market, days);
  solve_usual_days();
}

void OutlookProgram::save(BinaryWriter& out) const {
  out.put(battery_);
  out.put(gamma_);
  out.put(hour_);
  out.put(day_ahead_mean_);
  out.put(coefficients_);
  out.put(row_age_min_);
  out.put_list(levels_);
  chain_.save(out);
}

OutlookProgram::OutlookProgram(BinaryReader& in)
    : battery_(in.take<BatteryParameters>()),
      gamma_(in.take<double>()),
      grid_(battery_, kSocPoints),
      hour_(in.take<ByQuarterHour>()),
      day_ahead_mean_(in.take<ByQuarterHour>()),
      coefficients_(in.take<Coefficients>()),
      row_age_min_(in.take<int>()),
      levels_(in.take_list<double>()),
      chain_(in),
      recursion_(battery_, grid_, gamma_),
      cache_(std::make_shared<ValueCache>()) {
  if (levels_.size() < 2) in.damaged("has a program with an outlook of another size");
  solve_usual_days();
}

double OutlookProgram::usual(double day_ahead, int quarter_hour, double level) const {
  return coefficients_.constant + coefficients_.day_ahead * day_ahead +
         coefficients_.hour * hour_[static_cast<std::size_t>(quarter_hour)] +
         coefficients_.level * level;
}

double OutlookProgram::known_or_usual(const MarketStep& step, std::int64_t utc_s) const {
  const double known = step.day_ahead_eur_per_mwh(utc_s);
  return is_published(known) ? known
                             : day_ahead_mean_[static_cast<std::size_t>(quarter_hour_of(utc_s))];
}

void OutlookProgram::fit_means(const MarketSteps& market, const std::vector<MarketDay>& days) {
  MeanByQuarterHour paid, day_ahead;
  std::map<int, int> ages;
  for_each_step(market, days, [&](const MarketStep& step) {
    ++ages[step.observed_age_min];
    paid.add(step.quarter_hour, step.paid_eur_per_mwh);
    const double known = step.day_ahead_eur_per_mwh(step.utc_s);
    if (is_published(known)) day_ahead.add(step.quarter_hour, known);
  });
  if (day_ahead.weight() == 0) {
    fail("no day-ahead price on the days to fit on; pass a file that covers them (--day-ahead)");
  }
  row_age_min_ = std::ranges::max_element(ages, {}, &std::pair<const int, int>::second)->first;
  hour_ = paid.smoothed(kHourSmoothing);
  day_ahead_mean_ = day_ahead.smoothed(kHourSmoothing);
}

/// Regression slope of a day's mean height over d on that of the previous day.
void OutlookProgram::fit_lasting(const MarketSteps& market, const std::vector<MarketDay>& days) {
  double products = 0, squares = 0, before = 0;
  std::int64_t before_utc_s = 0;
  for (const MarketDay& day : days) {
    double sum = 0, count = 0;
    for (const MarketStep& step : market.of(day)) {
      const double known = step.day_ahead_eur_per_mwh(step.utc_s);
      if (!is_published(known)) continue;
      sum += known - day_ahead_mean_[static_cast<std::size_t>(step.quarter_hour)];
      count += 1;
    }
    if (count == 0) continue;
    const std::int64_t utc_s = market.of(day).front().utc_s;
    const double height = sum / count;
    constexpr std::int64_t kNextDayMax_s = 36 * 3600;
    if (before_utc_s != 0 && utc_s - before_utc_s < kNextDayMax_s) {
      products += height * before;
      squares += before * before;
    }
    before = height;
    before_utc_s = utc_s;
  }
  coefficients_.lasting = squares > 0 ? std::clamp(products / squares, 0.0, 1.0) : 0.0;
}

void OutlookProgram::fit_coefficients(const MarketSteps& market,
                                      const std::vector<MarketDay>& days) {
  using Square = Eigen::Matrix<double, kTerms, kTerms>;
  using Column = Eigen::Matrix<double, kTerms, 1>;
  Square normal = Square::Zero();
  Column right = Column::Zero();
  for (const MarketDay& day : days) {
    const double start_level = market.of(day).front().level_eur_per_mwh();
    for (const MarketStep& step : market.of(day)) {
      const double known = step.day_ahead_eur_per_mwh(step.utc_s);
      if (!is_published(known)) continue;
      const Column terms{1, known, hour_[static_cast<std::size_t>(step.quarter_hour)], start_level};
      normal += terms * terms.transpose();
      right += terms * step.paid_eur_per_mwh;
    }
  }
  // Constant prices have no slopes: a small ridge keeps only the constant.
  constexpr double kRidge = 1e-6;
  normal.diagonal().array() += kRidge;
  const Column fitted = normal.ldlt().solve(right);
  coefficients_.constant = fitted[0];
  coefficients_.day_ahead = fitted[1];
  coefficients_.hour = fitted[2];
  coefficients_.level = fitted[3];
}

void OutlookProgram::fit_chain(const MarketSteps& market, const std::vector<MarketDay>& days) {
  std::vector<DeviationChain::Sample> samples;
  std::int64_t follows_utc_s = 0;
  for_each_step(market, days, [&](const MarketStep& step) {
    const double level = step.level_eur_per_mwh();
    const auto usual_of = [&](std::int64_t utc_s) {
      return usual(known_or_usual(step, utc_s), quarter_hour_of(utc_s), level);
    };
    const auto [first, second] = paid_minutes(step.utc_s);
    samples.push_back({step.half_hour_phase, step.observed_eur_per_mwh - usual_of(row_utc_s(step)),
                       step.paid_eur_per_mwh - 0.5 * (usual_of(first) + usual_of(second)),
                       step.utc_s == follows_utc_s});
    follows_utc_s = step.utc_s + kSecondsPerStep;
  });
  chain_ = DeviationChain(samples, kBinSmoothing);
}

void OutlookProgram::solve_usual_days() {
  std::vector<float> ahead(kRow);
  for (const double level : levels_) {
    std::vector<float> value(kRow, 0.0F);
    for (int step = kUsualDays * kStepsPerDay - 1; step >= 0; --step) {
      const int minute = step % kStepsPerDay * kMinutesPerStep;
      const auto usual_of = [&](int at_minute) {
        const int q = at_minute / kMinutesPerQuarterHour;
        return usual(day_ahead_mean_[static_cast<std::size_t>(q)], q, level);
      };
      recursion_.step_back(chain_, step % DeviationChain::kPhases, minute / kMinutesPerQuarterHour,
                           0.5 * (usual_of(minute) + usual_of(minute + 1)), ahead.data(),
                           value.data());
    }
    usual_days_.push_back(std::move(value));
  }
}

/// Mean height of the known prices of yesterday, today and tomorrow over d on the last known day; 0
/// if none is known.
double OutlookProgram::height_before(const MarketStep& step) const {
  for (const int later : {1, 0, -1}) {
    const std::int64_t from = local_midnight_utc_s(step.utc_s, later);
    const std::int64_t until = local_midnight_utc_s(step.utc_s, later + 1);
    double sum = 0, count = 0;
    for (std::int64_t utc_s = from; utc_s < until; utc_s += kSecondsPerQuarterHour) {
      const double known = step.day_ahead_eur_per_mwh(utc_s);
      if (!is_published(known)) continue;
      sum += known - day_ahead_mean_[static_cast<std::size_t>(quarter_hour_of(utc_s))];
      count += 1;
    }
    if (count > 0) return sum / count;
  }
  return 0;
}

OutlookProgram::Plan OutlookProgram::plan_of(const MarketStep& step) const {
  const std::int64_t tomorrow_utc_s = local_midnight_utc_s(step.utc_s, 1);
  Plan plan;
  plan.from_utc_s = step.utc_s;
  plan.end_utc_s = local_midnight_utc_s(step.utc_s, 2);
  plan.first_quarter_hour_utc_s = quarter_hour_start(row_utc_s(step));
  plan.until_utc_s = tomorrow_utc_s;
  if (step.day_ahead != nullptr) {
    plan.until_utc_s =
        std::min(plan.until_utc_s, step.day_ahead->next_known_utc_s(plan.first_quarter_hour_utc_s,
                                                                    plan.end_utc_s, step.utc_s));
  }
  const double height = coefficients_.lasting * height_before(step);
  for (std::int64_t utc_s = plan.first_quarter_hour_utc_s; utc_s < plan.end_utc_s;
       utc_s += kSecondsPerQuarterHour) {
    const double known = step.day_ahead_eur_per_mwh(utc_s);
    plan.day_ahead.push_back(
        is_published(known)
            ? known
            : day_ahead_mean_[static_cast<std::size_t>(quarter_hour_of(utc_s))] + height);
  }
  return plan;
}

double OutlookProgram::usual_at(const Plan& plan, std::int64_t utc_s, double level) const {
  const std::int64_t q = (utc_s - plan.first_quarter_hour_utc_s) / kSecondsPerQuarterHour;
  const auto last = static_cast<std::int64_t>(plan.day_ahead.size()) - 1;
  const auto at = static_cast<std::size_t>(std::clamp<std::int64_t>(q, 0, last));
  return usual(plan.day_ahead[at], quarter_hour_of(utc_s), level);
}

double OutlookProgram::usual_paid(const Plan& plan, std::int64_t step_utc_s, double level) const {
  const auto [first, second] = paid_minutes(step_utc_s);
  const double at_first = usual_at(plan, first, level);
  if (quarter_hour_start(first) == quarter_hour_start(second)) return at_first;
  return 0.5 * (at_first + usual_at(plan, second, level));
}

const std::vector<float>& OutlookProgram::continuation_of(int level, Plan& plan) const {
  const auto [found, is_new] = plan.continuation.try_emplace(level);
  std::vector<float>& continuation = found->second;
  if (!is_new) return continuation;
  const auto l = static_cast<std::size_t>(level);
  const auto steps = (plan.until_utc_s - plan.from_utc_s + kSecondsPerStep - 1) / kSecondsPerStep;
  continuation.resize(static_cast<std::size_t>(steps) * kRow);
  std::vector<float> value = usual_days_[l];
  std::vector<float> ahead(kRow);
  for (std::int64_t step = (plan.end_utc_s - plan.from_utc_s) / kSecondsPerStep - 1; step >= 0;
       --step) {
    const std::int64_t utc_s = plan.from_utc_s + step * kSecondsPerStep;
    const int phase = static_cast<int>(utc_s / 60 % 30) / kMinutesPerStep;
    float* to = step < steps ? &continuation[static_cast<std::size_t>(step) * kRow] : ahead.data();
    recursion_.step_back(chain_, phase, quarter_hour_of(utc_s), usual_paid(plan, utc_s, levels_[l]),
                         to, value.data());
  }
  return continuation;
}

OutlookProgram::GridPosition OutlookProgram::grid_position_of(const MarketStep& step,
                                                              Plan& plan) const {
  const double level = step.level_eur_per_mwh();
  const auto bins =
      chain_.between(step.observed_eur_per_mwh - usual_at(plan, row_utc_s(step), level));
  const auto anchors = between_levels(levels_, level);
  const auto row =
      static_cast<std::size_t>((step.utc_s - plan.from_utc_s) / kSecondsPerStep) * kRow +
      static_cast<std::size_t>(bins.lower) * kSocPoints;
  return {{&continuation_of(anchors.lower, plan)[row],
           anchors.weight > 0 ? &continuation_of(anchors.lower + 1, plan)[row] : nullptr},
          bins,
          anchors,
          chain_.paid(step.half_hour_phase, bins) + usual_paid(plan, step.utc_s, level),
          battery_.power_w_at(step.quarter_hour)};
}

std::array<double, kActionCount> OutlookProgram::action_values(const MarketStep& step,
                                                               double soc_frac, Plan& plan) const {
  return worth(grid_position_of(step, plan), soc_frac);
}

std::array<double, kActionCount> OutlookProgram::kept_action_values(const MarketStep& step,
                                                                    double soc_frac,
                                                                    Plan& plan) const {
  const std::lock_guard lock(cache_->mutex);
  const ValueCache::Entry* entry = cache_->find(step);
  if (entry == nullptr) {
    if (!plan.serves(step)) plan = plan_of(step);
    entry = &cache_->add(step, grid_position_of(step, plan));
  }
  return worth(entry->position, soc_frac);
}

void OutlookProgram::prepare(const MarketSteps& market, const std::vector<MarketDay>& days,
                             int threads) const {
  if (days.size() * kStepsPerDay > kKeptMax) return;
  parallel_for(days.size(), threads, [&](std::size_t d) {
    Plan plan;
    for (const MarketStep& step : market.of(days[d])) {
      if (!plan.serves(step)) plan = plan_of(step);
      const GridPosition position = grid_position_of(step, plan);
      const std::lock_guard lock(cache_->mutex);
      cache_->add(step, position);
    }
  });
}

std::array<double, kActionCount> OutlookProgram::worth(const GridPosition& position,
                                                       double soc_frac) const {
  const auto& [ahead, bins, anchors, price, full_w] = position;
  std::array<double, kActionCount> values_eur{};
  for (int a = 0; a < kActionCount; ++a) {
    const double wanted_w = power_sign(static_cast<Action>(a)) * full_w;
    const BatteryStep moved = battery_step(battery_, soc_frac, wanted_w, kHoursPerStep);
    const SocGrid::Position soc = grid_.position(moved.soc_frac);
    const auto of_level = [&, bins = bins](const float* values) {
      return (1 - bins.weight) * double{interpolate(values, soc)} +
             bins.weight * double{interpolate(values + kSocPoints, soc)};
    };
    values_eur[static_cast<std::size_t>(a)] =
        (1 - anchors.weight) * of_level(ahead[0]) +
        (anchors.weight > 0 ? anchors.weight * of_level(ahead[1]) : 0.0) -
        exchange_cost_eur(battery_, moved.power_w / kWattsPerMegawatt * kHoursPerStep, price);
  }
  return values_eur;
}

double OutlookProgram::continuation(const MarketStep& step, Plan& plan, float* value_eur) const {
  const GridPosition position = grid_position_of(step, plan);
  for (int p = 0; p < kSocPoints; ++p) {
    double ahead = 0;
    for (std::size_t l = 0; l < position.ahead.size(); ++l) {
      if (position.ahead[l] == nullptr) continue;
      const double weight = l == 0 ? 1 - position.levels.weight : position.levels.weight;
      ahead += weight * ((1 - position.bins.weight) * double{position.ahead[l][p]} +
                         position.bins.weight * double{position.ahead[l][kSocPoints + p]});
    }
    value_eur[p] = static_cast<float>(ahead);
  }
  return position.price_eur_per_mwh;
}

Action OutlookPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  return argmax_action(action_values(step, soc_frac).data());
}

std::array<double, kActionCount> OutlookPolicy::action_values(const MarketStep& step,
                                                              double soc_frac) const {
  return program_->kept_action_values(step, soc_frac, plan_);
}

std::string OutlookPolicy::description() const {
  const OutlookProgram::Coefficients& c = program_->coefficients();
  return fmt::format("usual = {:.1f} + {:.2f} day-ahead + {:.2f} by hour + {:.2f} level",
                     c.constant, c.day_ahead, c.hour, c.level);
}

}  // namespace bess
