#include "edge/core/site/meter_check.h"

#include <algorithm>

#include "edge/core/control/tick.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

// Points, chosen on random houses (tests/system/closed_loop/meter_liars_test.cpp): with 7, two of
// 96 months of 30 days had a false finding, with 10 none. A doubtful step is undone immediately, so
// that the fourth contradiction loads a limit no more than the third.
constexpr std::int32_t kContradicts = 3;
constexpr std::int32_t kLateAnswer = 3;
constexpr std::int32_t kTurnsAround = 2;
constexpr std::int32_t kFollows = 1;
constexpr std::int32_t kFoundFrom = 10;

/// Smaller steps, as a share of the rating, are lost in the house load.
constexpr std::int64_t kStepMinPermille = 100;
constexpr std::int64_t kMeterErrorW = 100;   ///< of both meters, at any power
constexpr std::int64_t kHouseFadesS = 600;   ///< time constant of the house variation
constexpr std::int64_t kDoubtFadesS = 600;   ///< per point
constexpr std::int64_t kHouseGapMaxS = 90;   ///< between two readings that measure the house
constexpr std::int64_t kWindowBeyondS = 60;  ///< a step is judged within settle_s plus this
constexpr std::int64_t kLateMaxS = 240;      ///< later changes are attributed to the house
constexpr std::int64_t kBeyondAnyW = 100'000'000;

constexpr std::int32_t kSumSteps = 16;    ///< covered by the sums
constexpr std::int32_t kSumStepsMin = 8;  ///< needed for a finding by sums
constexpr std::int32_t kTestSteps = 6;    ///< that end a finding
constexpr std::int64_t kPermilleMax = 4'000;
constexpr std::int64_t kRatioMin = 450;
constexpr std::int64_t kRatioMax = 2'000;
constexpr std::int64_t kRatioStandsS = 1'200;  ///< without another step that shows it

constexpr std::int64_t kFirstPauseS = 600;
constexpr std::int64_t kLongestPauseS = 6 * 3'600;
constexpr std::int64_t kForgetPauseS = kSecondsPerDay;

constexpr std::int64_t magnitude(std::int64_t power_w) { return power_w < 0 ? -power_w : power_w; }

std::int64_t house_w_of(const MeterCheckReading& reading) {
  return std::int64_t{reading.grid_w} - reading.battery_w;
}

}  // namespace

void MeterCheck::observe(const MeterCheckReading& now) {
  if (!settings_.judges) return;
  if (!now.order.is_driven || (before_ && now.utc_s < before_->utc_s)) before_.reset();
  if (!now.order.is_driven) return;
  // Within one second the reading came first: a settled reading cannot be of such a young order.
  const bool is_next_order = before_ && now.utc_s - now.order.age_s >= before_->utc_s;
  if (now.order.age_s < settings_.settle_s) {
    if (is_next_order) judge_excess(now);
    return;
  }
  if (is_next_order) {
    judge_step(now);
  } else if (before_) {
    note_house(now);
  }
  fade_doubt(now.utc_s);
  before_ = now;
}

/// Doubt decays: contradictions of one cause come close together.
void MeterCheck::fade_doubt(std::int64_t utc_s) {
  if (utc_s - faded_utc_s_ < kDoubtFadesS && utc_s >= faded_utc_s_) return;
  faded_utc_s_ = utc_s;
  if (!trust_.is_mismatch) trust_.doubt = std::max(trust_.doubt - 1, 0);
}

void MeterCheck::note_house(const MeterCheckReading& now) {
  const std::int64_t seconds = now.utc_s - before_->utc_s;
  const std::int64_t faded_s = std::min(seconds, kHouseFadesS);
  largest_move_w_ -= largest_move_w_ * faded_s / kHouseFadesS;
  noise_w_ -= noise_w_ * faded_s / kHouseFadesS;
  if (seconds > kHouseGapMaxS) return;
  const std::int64_t house_step_w = house_w_of(now) - house_w_of(*before_);
  if (is_late_answer(house_step_w, now.utc_s)) {
    missed_.reset();
    return on_contradiction(now, kLateAnswer);
  }
  if (turns_around(before_->grid_w, now.grid_w)) return on_contradiction(now, kTurnsAround);
  // The second largest: a single change may be the start of a meter fault.
  const std::int64_t move_w = magnitude(house_step_w);
  noise_w_ = std::max(noise_w_, std::min(move_w, largest_move_w_));
  largest_move_w_ = std::max(largest_move_w_, move_w);
}

/// Change of sign under one order, as of an intermittently inverted meter.
bool MeterCheck::turns_around(std::int64_t from_w, std::int64_t to_w) const {
  return magnitude(to_w - from_w) >= settings_.power_w &&
         magnitude(to_w + from_w) <= magnitude(to_w - from_w) / 16 + kMeterErrorW;
}

/// Otherwise a lagging meter would be mistaken for house-load noise.
bool MeterCheck::is_late_answer(std::int64_t house_step_w, std::int64_t utc_s) const {
  if (!missed_ || utc_s - missed_->utc_s > kLateMaxS) return false;
  const std::int64_t missed_w = missed_->power_w;
  return magnitude(house_step_w - missed_w) <= magnitude(missed_w) / 8 + kMeterErrorW;
}

void MeterCheck::judge_step(const MeterCheckReading& now) {
  if (now.utc_s - before_->utc_s > settings_.settle_s + kWindowBeyondS) return;
  const Step step = step_to(now);
  if (step.size_w * 1'000 < settings_.power_w * kStepMinPermille) return;
  note_ratio(step, now.utc_s);
  missed_.reset();
  // The step was observed: 0 W until the next tick keeps the exposure short.
  if (trust_.is_mismatch) test_power_until_utc_s_ = next_tick_utc_s(now.utc_s);
  if (contradicts(step)) {
    missed_ = {.power_w = std::int64_t{now.battery_w} - before_->battery_w, .utc_s = now.utc_s};
    return on_contradiction(now, kContradicts);
  }
  const std::int64_t error_w = magnitude(step.along_w - step.size_w);
  const bool follows = error_w <= step.size_w / 4 + kMeterErrorW;
  if (trust_.is_mismatch) {
    if (follows) judge_test(step, now.utc_s);
    return;
  }
  if (follows) trust_.doubt = std::max(trust_.doubt - kFollows, 0);
  if (step.size_w < 2 * noise_w_) return;  // the ratio would be due to the house
  add_to_sums(step);
  if (is_wrong_ratio()) find(now.utc_s);
}

/// A meter that shows far too much cuts each order before it has settled. It is judged as soon as
/// the battery's power has come, because a lag shows less, not more.
void MeterCheck::judge_excess(const MeterCheckReading& now) {
  const Step step = step_to(now);
  if (step.size_w * 4 < settings_.power_w) return;
  const std::int64_t excess_w = step.along_w - step.size_w;
  if (excess_w * 2 <= step.size_w * 3 || excess_w <= 2 * (noise_w_ + kMeterErrorW)) return;
  before_.reset();  // counted once
  on_contradiction(now, kContradicts);
}

/// Below the minimum it is a contradiction or the house, and gives no ratio.
void MeterCheck::note_ratio(const Step& step, std::int64_t utc_s) {
  const std::int64_t error_w = magnitude(step.along_w - step.size_w);
  const bool follows = error_w <= step.size_w / 10 + kMeterErrorW;
  const std::int64_t permille = follows ? kTrueRatio : step.along_w * kTrueRatio / step.size_w;
  std::move(shown_.begin() + 1, shown_.end(), shown_.begin());
  shown_.back() = {.utc_s = utc_s,
                   .permille = permille < kRatioMin
                                   ? kTrueRatio
                                   : static_cast<std::int32_t>(std::min(permille, kRatioMax))};
}

MeterRatios MeterCheck::possible_ratios(std::int64_t now_utc_s) const {
  MeterRatios ratios;
  for (const ObservedRatio& shown : shown_) {
    if (magnitude(now_utc_s - shown.utc_s) > kRatioStandsS) continue;
    ratios.least_permille = std::min(ratios.least_permille, shown.permille);
    ratios.most_permille = std::max(ratios.most_permille, shown.permille);
  }
  return ratios;
}

MeterCheck::Step MeterCheck::step_to(const MeterCheckReading& now) const {
  const std::int64_t battery_w = std::int64_t{now.battery_w} - before_->battery_w;
  const std::int64_t grid_w = std::int64_t{now.grid_w} - before_->grid_w;
  return {.size_w = magnitude(battery_w), .along_w = battery_w < 0 ? -grid_w : grid_w};
}

bool MeterCheck::contradicts(const Step& step) const {
  const std::int64_t shortfall_w = step.size_w - step.along_w;
  const bool is_short =
      shortfall_w * 5 > step.size_w * 2 && shortfall_w > 2 * (noise_w_ + kMeterErrorW);
  // More negative than an inverted meter: the house.
  return is_short && step.along_w >= -step.size_w * 3 / 2 - 2 * kMeterErrorW;
}

void MeterCheck::on_contradiction(const MeterCheckReading& now, std::int32_t points) {
  test_power_until_utc_s_ = next_tick_utc_s(now.utc_s);
  if (state_at(now.utc_s) == State::kPaused) return;
  trust_.doubt = std::min(trust_.doubt + points, kFoundFrom);
  if (trust_.is_mismatch || trust_.doubt >= kFoundFrom) find(now.utc_s);
}

/// Updates the sums over the last steps, in permille of the rating: x battery step, e meter error.
void MeterCheck::add_to_sums(const Step& step) {
  const auto permille = [this](std::int64_t power_w, std::int64_t limit) {
    const std::int64_t within_w = std::clamp(power_w, -kBeyondAnyW, kBeyondAnyW);
    return std::clamp(within_w * 1'000 / settings_.power_w, -limit, limit);
  };
  const std::int64_t x = permille(step.size_w, kPermilleMax);
  const std::int64_t e = permille(step.along_w - step.size_w, 2 * kPermilleMax);
  if (trust_.steps >= kSumSteps) {
    trust_.steps -= 1;
    trust_.step_squares -= trust_.step_squares / kSumSteps;
    trust_.error_products -= trust_.error_products / kSumSteps;
    trust_.error_squares -= trust_.error_squares / kSumSteps;
  }
  trust_.steps += 1;
  trust_.step_squares += x * x;
  trust_.error_products += x * e;
  trust_.error_squares += e * e;
}

/// Ratio off 1 by more than a quarter, and correlation of error and step above sqrt(1/2).
bool MeterCheck::is_wrong_ratio() const {
  const MeterTrust& t = trust_;
  if (t.steps < kSumStepsMin) return false;
  return magnitude(t.error_products) * 4 > t.step_squares &&
         2 * t.error_products * t.error_products > t.step_squares * t.error_squares;
}

/// After a pause, matching steps end the finding if the sums agree too.
void MeterCheck::judge_test(const Step& step, std::int64_t utc_s) {
  if (state_at(utc_s) == State::kPaused) return;
  add_to_sums(step);
  if (trust_.steps < kTestSteps) return;
  if (magnitude(trust_.error_products) * 4 > trust_.step_squares) return find(utc_s);
  trust_ = MeterTrust{.pause_until_utc_s = trust_.pause_until_utc_s, .pause_s = trust_.pause_s};
}

void MeterCheck::find(std::int64_t utc_s) {
  const bool is_forgotten = !trust_.is_mismatch && utc_s - trust_.pause_until_utc_s > kForgetPauseS;
  const std::int64_t pause_s = trust_.pause_s <= 0 || is_forgotten
                                   ? kFirstPauseS
                                   : std::min(2 * std::int64_t{trust_.pause_s}, kLongestPauseS);
  trust_ = {.is_mismatch = true,
            .doubt = kFoundFrom,
            .pause_until_utc_s = utc_s + pause_s,
            .pause_s = static_cast<std::int32_t>(pause_s)};
}

MeterCheck::State MeterCheck::state_at(std::int64_t now_utc_s) const {
  if (!trust_.is_mismatch) return State::kTrusted;
  const std::int64_t left_s = trust_.pause_until_utc_s - now_utc_s;
  return left_s > 0 && left_s <= kLongestPauseS ? State::kPaused : State::kTested;
}

std::int32_t MeterCheck::power_w_max(std::int64_t now_utc_s) const {
  // A clock step backwards extends neither.
  const std::int64_t retreat_s = test_power_until_utc_s_ - now_utc_s;
  const bool retreats = retreat_s > 0 && retreat_s <= kSecondsPerStep;
  if (retreats) return 0;
  const State state = state_at(now_utc_s);
  // A test is on in every second cycle, so that there are steps to judge.
  const bool is_on = now_utc_s / kSecondsPerStep % 2 != 0;
  if (state == State::kTested) return is_on ? settings_.power_w / 8 : 0;
  return state == State::kTrusted ? kAnyPowerW : 0;
}

}  // namespace bess
