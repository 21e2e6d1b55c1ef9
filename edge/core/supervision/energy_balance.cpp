#include "edge/core/supervision/energy_balance.h"

#include <algorithm>
#include <cstdlib>

namespace bess {

namespace {

constexpr std::int64_t kIntervalMaxS = 3'600;

}  // namespace

void SparseSocCheck::begin(const Response& now) {
  path_.begin(now.steady_s);
  noted_s_ = now.steady_s;
  now_ = before_ = reading_of(now, INT64_MIN / 2);
  restart_interval();
  restart_standstill();
}

void SparseSocCheck::note_power(const Response& now, std::int32_t power_before_w) {
  const std::int64_t seconds = std::max<std::int64_t>(now.steady_s - noted_s_, 0);
  const std::int64_t of_order_s = std::clamp<std::int64_t>(now.order_age_s, 0, seconds);
  const std::int32_t power_w = now.measurement.power_w;
  path_.add(now.steady_s - of_order_s, power_before_w);
  path_.add(now.steady_s, power_w);
  moved_ws_ += std::abs(std::int64_t{power_before_w}) * (seconds - of_order_s) +
               std::abs(std::int64_t{power_w}) * of_order_s;
  noted_s_ = now.steady_s;
}

void SparseSocCheck::observe(const Response& now) {
  before_ = now_;
  const bool is_new = now.measurement.soc_e4 != before_.soc_e4;
  now_ = reading_of(now, is_new ? before_.steady_s : INT64_MIN / 2);
  ++still_readings_;
  if (is_new) restart_standstill();
}

/// Power may lag by the settling time, the SoC by its refresh time.
SparseSocCheck::Reading SparseSocCheck::reading_of(const Response& now,
                                                   std::int64_t refreshed_after_s) const {
  const std::int64_t refreshed_s =
      std::max(now.steady_s - settings_.band.soc_refresh_s, refreshed_after_s);
  return {.steady_s = now.steady_s,
          .soc_e4 = now.measurement.soc_e4,
          .energy = path_.since(refreshed_s - settings_.band.settle_s, settings_.power_w),
          .energy_ws = path_.energy_ws(),
          .moved_ws = moved_ws_};
}

bool SparseSocCheck::take_interval(Interval& interval) {
  interval = {.energy_ws = now_.energy_ws - from_.energy_ws,
              .surely_ws = now_.energy.since(from_.energy).surely_ws(),
              .soc_e4 = now_.soc_e4 - from_.soc_e4,
              .seconds = now_.steady_s - from_.steady_s};
  const std::int64_t energy_ws = std::abs(interval.energy_ws);
  const bool is_sure = std::abs(interval.surely_ws) * 4 >= energy_ws * 3 &&
                       (interval.surely_ws < 0) == (interval.energy_ws < 0);
  const bool is_one_way = (now_.moved_ws - from_.moved_ws) * 2 <= energy_ws * 3;
  if (energy_ws == 0 || !is_sure || !is_one_way) return false;
  restart_interval();
  return true;
}

bool SparseSocCheck::is_too_long() const { return now_.steady_s - from_.steady_s > kIntervalMaxS; }

namespace {

using Kind = EnergyInterval::Kind;

// Shares of the measured energy in percent. A capacity error of 15 %, losses of 10 % each way and a
// response delayed by half a minute stay within 70 and 150.
constexpr std::int64_t kReportedBelow = 70;
constexpr std::int64_t kReportedAbove = 150;
constexpr std::int64_t kContradictedBelow = 40;
constexpr std::int64_t kContradictedAbove = 250;
constexpr int kIntervalsToTell = 6;
constexpr int kIntervalsToContradict = 2;
/// With this many intervals delays are averaged out.
constexpr int kIntervalsBeyondDelay = 15;
constexpr int kIntervalsOfRest = 5;        ///< before an unmeasured loss is reported
constexpr int kIntervalsOfShownRest = 10;  ///< before a measured one is

/// Drift under orders in both directions: beyond conversion losses, and beyond the effect of a
/// wrong capacity on the net energy.
constexpr std::int64_t kLostOnTheWayPercent = 15;
constexpr std::int64_t kUsuallyLostPercent = 5;
constexpr std::int64_t kWrongScalePercent = 35;
constexpr int kIntervalsOfDrift = 10;

/// Half standard deviations. A healthy battery is far from either bound, so few are enough.
constexpr std::int64_t kHalfSigmasToTell = 4;
constexpr std::int64_t kHalfSigmasToContradict = 5;
constexpr std::int64_t kPercent = 100;
/// Error of any SoC in addition to its resolution, in 1e-4 of the capacity.
constexpr std::int64_t kSocErrorE4 = 15;
/// A slow SoC recalibration at rest may move this much; more is no counting error.
constexpr std::int64_t kRestContradictedE4 = 2'000;

/// Sum of contributions, and the largest of them.
struct Evidence {
  std::int64_t sum = 0;
  std::int64_t largest = 0;

  void add(std::int64_t contribution) {
    sum += contribution;
    largest = std::max(largest, contribution);
  }
  /// Without its largest contribution it still exceeds noise of this standard deviation.
  [[nodiscard]] bool holds(std::int64_t half_sigmas, std::int64_t deviation) const {
    return 2 * (sum - largest) > half_sigmas * deviation;
  }
  [[nodiscard]] bool is_significant(std::int64_t deviation) const {
    return holds(kHalfSigmasToTell, deviation);
  }
  [[nodiscard]] bool contradicts(std::int64_t deviation) const {
    return holds(kHalfSigmasToContradict, deviation);
  }
};

/// Rounded up.
std::int64_t square_root(std::int64_t square) {
  std::int64_t root = 0;
  for (std::int64_t bit = std::int64_t{1} << 31; bit > 0; bit >>= 1) {
    if ((root + bit) * (root + bit) <= square) root += bit;
  }
  return root * root < square ? root + 1 : root;
}

/// Sum of (e_i - e_(i+1))^2 over a span that grows backwards, zero outside it.
class Roughness {
 public:
  void add(std::int64_t energy_e4) {
    const std::int64_t difference = energy_e4 - oldest_;
    inner_ += difference * difference;
    oldest_ = energy_e4;
  }
  [[nodiscard]] std::int64_t sum() const { return inner_ + oldest_ * oldest_; }

 private:
  std::int64_t inner_ = 0;
  std::int64_t oldest_ = 0;
};

/// Contribution to "less than `percent` of the energy arrives"; negated: more than that.
std::int64_t deficit(std::int64_t percent, std::int64_t energy_e4, std::int64_t soc_e4) {
  return (percent * energy_e4 - kPercent * soc_e4) * energy_e4;
}

/// As above, against the minimum of a healthy battery. After a change of the order a delay cannot
/// be distinguished from missing energy: then only energy beyond any delay counts, and nothing
/// counts against it.
std::int64_t lack_beyond_delay(const EnergyInterval& interval) {
  const std::int64_t energy = interval.energy_e4;
  const std::int64_t late = interval.late_energy_e4;
  if (late == energy) return deficit(kContradictedBelow, energy, interval.soc_e4);
  const bool turns = (late < 0) != (energy < 0);
  const std::int64_t least = (turns ? kReportedAbove : kContradictedBelow) * late;
  return std::max<std::int64_t>((least - kPercent * interval.soc_e4) * energy, 0);
}

}  // namespace

void EnergyBalance::add(const EnergyInterval& interval) {
  intervals_[next_] = interval;
  next_ = (next_ + 1) % kIntervals;
  count_ = std::min(count_ + 1, kIntervals);
}

void EnergyBalance::observe(const EnergyInterval& interval, std::int32_t soc_span_e4) {
  add(interval);
  findings_ = Findings{};
  const std::int64_t span = soc_span_e4;
  const std::int64_t soc_variance = span * span / 12 + kSocErrorE4 * kSocErrorE4;
  judge_flow(soc_variance);
  judge_rest(soc_variance);
  if (findings_.rest_loss_w == 0) judge_drift(soc_variance);
}

void EnergyBalance::judge_flow(std::int64_t soc_variance) {
  Evidence little, much, far_too_little, far_too_little_so_far, far_too_much;
  Roughness roughness, beyond_delay;
  std::int64_t explained = 0, shown = 0;  // the share is shown / explained
  int flowing = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const EnergyInterval& interval = back(i);
    const bool flows = interval.kind == Kind::kFlowing;
    const std::int64_t energy = flows ? interval.energy_e4 : 0;
    roughness.add(energy);
    const std::int64_t lacking = flows ? lack_beyond_delay(interval) : 0;
    beyond_delay.add(lacking != 0 ? energy : 0);  // intervals without evidence add no noise
    if (!flows) continue;
    ++flowing;
    little.add(deficit(kReportedBelow, energy, interval.soc_e4));
    much.add(-deficit(kReportedAbove, energy, interval.soc_e4));
    far_too_little.add(lacking);
    far_too_little_so_far.add(deficit(kContradictedBelow, energy, interval.soc_e4));
    far_too_much.add(-deficit(kContradictedAbove, energy, interval.soc_e4));
    explained += energy * energy;
    shown += energy * interval.soc_e4;
    const std::int64_t noise = kPercent * square_root(soc_variance * roughness.sum());
    const std::int64_t noise_beyond = kPercent * square_root(soc_variance * beyond_delay.sum());
    if (flowing >= kIntervalsToContradict &&
        (far_too_little.contradicts(noise_beyond) || far_too_much.contradicts(noise))) {
      findings_.contradicts = true;
    }
    if (flowing >= kIntervalsBeyondDelay && far_too_little_so_far.contradicts(noise)) {
      findings_.contradicts = true;
    }
    if (flowing >= kIntervalsToTell &&
        (little.is_significant(noise) || much.is_significant(noise))) {
      const std::int64_t percent = explained > 0 ? 100 * shown / explained : 0;
      // 0 means no finding.
      findings_.share_percent = static_cast<std::int16_t>(
          percent == 0 ? 1 : std::clamp<std::int64_t>(percent, -1'000, 1'000));
    }
  }
}

/// At 0 W: the measured power, and the additional loss of the SoC.
void EnergyBalance::judge_rest(std::int64_t soc_variance) {
  const std::int64_t capacity_ws = std::int64_t{3'600} * settings_.capacity_wh;
  const std::int64_t allowed_w = std::int64_t{settings_.noise_w()} * 5 / 4;
  Evidence lost, gained, lost_for_good, drawn;
  std::int64_t seconds = 0, unmeasured_e4 = 0, drawn_ws = 0;
  int resting = 0, spells = 0;
  bool was_resting = false;
  for (std::size_t i = 0; i < count_; ++i) {
    const EnergyInterval& interval = back(i);
    const bool rests = interval.kind == Kind::kResting;
    if (rests && !was_resting) ++spells;
    was_resting = rests;
    if (!rests) continue;
    ++resting;
    const std::int64_t allowed_e4 = allowed_w * interval.seconds * 10'000 / capacity_ws;
    const std::int64_t missing_e4 = interval.energy_e4 - interval.soc_e4;
    lost.add(missing_e4 - allowed_e4);
    gained.add(-missing_e4 - allowed_e4);
    lost_for_good.add(missing_e4);
    drawn.add(-interval.power_w - allowed_w);
    seconds += interval.seconds;
    unmeasured_e4 += missing_e4;
    drawn_ws -= std::int64_t{interval.power_w} * interval.seconds;
    const std::int64_t noise = square_root(2 * spells * soc_variance);
    const bool is_unmeasured = lost.is_significant(noise) ||
                               (gained.is_significant(noise) && !settings_.band.charges_by_itself);
    const bool is_shown = resting >= kIntervalsOfShownRest && drawn.is_significant(0);
    if ((resting >= kIntervalsOfRest && is_unmeasured) || is_shown) {
      const std::int64_t hidden_ws = is_unmeasured ? unmeasured_e4 * capacity_ws / 10'000 : 0;
      findings_.rest_loss_w = static_cast<std::int32_t>((hidden_ws + drawn_ws) / seconds);
    }
    if (lost_for_good.sum - lost_for_good.largest > kRestContradictedE4 &&
        lost.is_significant(noise)) {
      findings_.contradicts = true;
    }
  }
}

/// Under orders: s_i = k e_i + b t_i, with an unmeasured loss b. Orders in both directions separate
/// b from k.
void EnergyBalance::judge_drift(std::int64_t soc_variance) {
  const std::int64_t capacity_ws = std::int64_t{3'600} * settings_.capacity_wh;
  const std::int64_t allowed_w = std::int64_t{settings_.noise_w()} * 5 / 4;
  Evidence lost, gained;
  std::int64_t seconds = 0, moved_e4 = 0, net_e4 = 0;
  int flowing = 0, spells = 0;
  bool was_flowing = false;
  for (std::size_t i = 0; i < count_; ++i) {
    const EnergyInterval& interval = back(i);
    const bool flows = interval.kind == Kind::kFlowing;
    if (flows && !was_flowing) ++spells;
    was_flowing = flows;
    if (!flows) continue;
    ++flowing;
    const std::int64_t missing_e4 = interval.energy_e4 - interval.soc_e4;
    lost.add(missing_e4);
    gained.add(-missing_e4);
    seconds += interval.seconds;
    moved_e4 += std::abs(interval.energy_e4);
    net_e4 += interval.energy_e4;
    if (flowing < kIntervalsOfDrift) continue;
    const std::int64_t allowed_e4 =
        (kLostOnTheWayPercent * moved_e4 + kWrongScalePercent * std::abs(net_e4)) / kPercent +
        allowed_w * seconds * 10'000 / capacity_ws;
    const std::int64_t noise = square_root(2 * spells * soc_variance);
    const auto beyond_e4 = [&](const Evidence& e) { return e.sum - e.largest - allowed_e4; };
    const bool loses = 2 * beyond_e4(lost) > kHalfSigmasToTell * noise;
    const bool gains =
        2 * beyond_e4(gained) > kHalfSigmasToTell * noise && !settings_.band.charges_by_itself;
    if (!loses && !gains) continue;
    if (findings_.share_percent == 0) {  // else already reported
      const std::int64_t drift_e4 = lost.sum - kUsuallyLostPercent * moved_e4 / kPercent;
      findings_.rest_loss_w = static_cast<std::int32_t>(drift_e4 * capacity_ws / 10'000 / seconds);
    }
    const std::int64_t most_e4 = std::max(beyond_e4(lost), gains ? beyond_e4(gained) : 0);
    if (most_e4 > kRestContradictedE4) findings_.contradicts = true;
  }
}

}  // namespace bess
