#include "shared/host/exchange.h"

#include <algorithm>
#include <cmath>

#include "shared/local_time.h"

namespace bess {
namespace {

constexpr double kSecondsPerHour = 3'600;
/// Time limit for a normal write of an order; later with a late price.
constexpr double kWrittenWithinS = 60;
/// Gaps up to this time with equal power at both ends and an order of that power: constant power.
constexpr std::int64_t kShortGapS = 600;

bool is_close(double power_w, double other_w) {
  constexpr double kApartW = 50, kApartShare = 0.03;
  return std::fabs(power_w - other_w) <= std::max(kApartW, kApartShare * std::fabs(other_w));
}

using Visit = std::function<void(const Exchange&)>;

/// Consecutive stretches of constant power between two samples.
class FlowIntervals {
 public:
  FlowIntervals(const ExchangeSample& from, const ExchangeSample& until, const Visit& visit)
      : at_s_(static_cast<double>(from.utc_s)),
        end_s_(static_cast<double>(until.utc_s)),
        visit_(visit) {}

  [[nodiscard]] double left_s() const { return end_s_ - at_s_; }

  [[nodiscard]] double energy_wh() const { return energy_wh_; }

  /// For the remaining time.
  void flow(double power_w) { flow(power_w, left_s()); }
  /// For `seconds`, at most the remaining time.
  void flow(double power_w, double seconds, bool is_seen = true) {
    const double until_s = std::min(at_s_ + seconds, end_s_);
    energy_wh_ += power_w * std::max(until_s - at_s_, 0.0) / kSecondsPerHour;
    while (at_s_ < until_s) {
      const double quarter_end_s =
          (std::floor(at_s_ / kSecondsPerQuarterHour) + 1) * kSecondsPerQuarterHour;
      const double stop_s = std::min(until_s, quarter_end_s);
      visit_({.from_utc_s = at_s_,
              .until_utc_s = stop_s,
              .energy_wh = power_w * (stop_s - at_s_) / kSecondsPerHour,
              .is_seen = is_seen});
      at_s_ = stop_s;
    }
  }

 private:
  double at_s_;
  double end_s_;
  double energy_wh_ = 0;
  const Visit& visit_;
};

/// Walk over samples, with a finer charge count than the display of the battery.
class FlowIntegrator {
 public:
  FlowIntegrator(const ChargeScale& scale, const ExchangeSample& first, const Visit& visit)
      : scale_(scale), visit_(visit), soc_e4_(first.soc_e4), order_before_w_(first.power_w) {
    ExchangeSample before = first;
    before.utc_s -= kSecondsPerStep;
    FlowIntervals(before, first, visit).flow(first.power_w);
  }

  void go(const ExchangeSample& from, const ExchangeSample& until) {
    if (until.utc_s < from.utc_s) return anchor(until);
    FlowIntervals intervals(from, until, visit_);
    const double head_s = std::min<double>(from.written_after_s, kWrittenWithinS);
    intervals.flow(from.power_w, head_s);
    if (is_constant(from, until)) {
      intervals.flow(until.power_w);
    } else if (is_gap(from, until)) {
      report_gap(from, until, intervals);
    } else {
      report_change(from, until, intervals);
    }
    count(intervals.energy_wh(), until);
    if (is_gap(from, until)) anchor(until);
    order_before_w_ = ordered_w(from);
  }

 private:
  static double ordered_w(const ExchangeSample& from) {
    return from.is_ordered ? from.order_w : from.power_w;
  }
  static bool is_gap(const ExchangeSample& from, const ExchangeSample& until) {
    return until.utc_s - from.utc_s > kSecondsPerStep;
  }

  [[nodiscard]] bool is_constant(const ExchangeSample& from, const ExchangeSample& until) const {
    const bool follows = is_close(until.power_w, ordered_w(from));
    if (is_gap(from, until))
      return follows && from.is_ordered && until.utc_s - from.utc_s <= kShortGapS;
    // A battery with constantly less power than ordered.
    const bool is_same =
        from.is_ordered && from.order_w == order_before_w_ && is_close(until.power_w, from.power_w);
    return follows || is_same;
  }

  /// Energy since the older sample from the SoC, minus energy already counted.
  [[nodiscard]] double by_soc_wh(const ExchangeSample& until, const FlowIntervals& reported) const {
    return scale_.energy_wh(until.soc_e4 - soc_e4_, until.capacity_wh) - reported.energy_wh();
  }

  /// Ordered power first, then measured power; the SoC gives the time of the change.
  void report_change(const ExchangeSample& from, const ExchangeSample& until,
                     FlowIntervals& intervals) const {
    const double left_h = intervals.left_s() / kSecondsPerHour;
    const double found_wh = until.power_w * left_h;
    const double ordered_wh = ordered_w(from) * left_h;
    const double soc_wh = by_soc_wh(until, intervals);
    const double step_wh = 1.5 * scale_.soc_step_e4 / kSocFullE4 * until.capacity_wh;
    const bool says_nothing =
        until.capacity_wh <= 0 || scale_.stands_still() ||
        (!scale_.is_at_an_end(until.soc_e4) && std::fabs(soc_wh - found_wh) <= step_wh);
    const auto [low_wh, high_wh] = std::minmax(found_wh, ordered_wh);
    const double flowed_wh = says_nothing ? found_wh : std::clamp(soc_wh, low_wh, high_wh);
    const double share = (flowed_wh - found_wh) / (ordered_wh - found_wh);
    intervals.flow(ordered_w(from), share * left_h * kSecondsPerHour);
    intervals.flow(until.power_w);
  }

  /// The order in force continues until the energy is reached; without an order constant power.
  void report_gap(const ExchangeSample& from, const ExchangeSample& until,
                  FlowIntervals& intervals) const {
    constexpr bool kIsSeen = false;
    const double order_w = from.is_ordered ? from.order_w : 0;
    double rest_wh = scale_.energy_wh(until.soc_e4 - from.soc_e4, until.capacity_wh);
    if (rest_wh != 0) rest_wh -= intervals.energy_wh();
    if (order_w * rest_wh > 0) {
      const double seconds = std::min(rest_wh / order_w * kSecondsPerHour, intervals.left_s());
      intervals.flow(order_w, seconds, kIsSeen);
      rest_wh -= order_w * seconds / kSecondsPerHour;
    }
    const double left_s = intervals.left_s();
    if (left_s > 0) intervals.flow(rest_wh * kSecondsPerHour / left_s, left_s, kIsSeen);
  }

  void anchor(const ExchangeSample& sample) { soc_e4_ = sample.soc_e4; }

  /// Limited to the resolution of the display.
  void count(double energy_wh, const ExchangeSample& until) {
    if (until.capacity_wh <= 0) return;
    soc_e4_ =
        std::clamp<double>(soc_e4_ + scale_.moved_e4(energy_wh, until.capacity_wh),
                           until.soc_e4 - scale_.soc_step_e4, until.soc_e4 + scale_.soc_step_e4);
  }

  const ChargeScale& scale_;
  const Visit& visit_;
  double soc_e4_;
  double order_before_w_;
};

/// Energy from power, and change of charge, over stretches of one order.
struct MeasuredCharge {
  double energy_wh = 0;
  double charge_wh = 0;

  /// False until the change of charge exceeds half of the capacity.
  [[nodiscard]] bool is_sufficient(double capacity_wh) const { return charge_wh > capacity_wh / 2; }
};

constexpr double sane(double efficiency) { return std::clamp(efficiency, 0.6, 1.0); }

void integrate_along(std::span<const ExchangeSample> samples, const ChargeScale& scale,
                     const Visit& visit) {
  FlowIntegrator integrator(scale, samples.front(), visit);
  for (std::size_t i = 1; i < samples.size(); ++i) integrator.go(samples[i - 1], samples[i]);
}

/// Common efficiency e of both directions that matches the charge at both ends:
/// in * e - out / e = stored.
ChargeScale balanced(ChargeScale scale, std::span<const ExchangeSample> samples) {
  double in_wh = 0, out_wh = 0;
  integrate_along(samples, scale, [&](const Exchange& e) {
    if (e.from_utc_s < static_cast<double>(samples.front().utc_s)) return;
    in_wh += e.charged_wh();
    out_wh += e.discharged_wh();
  });
  const double capacity_wh = samples.back().capacity_wh;
  const double stored_wh = (samples.back().soc_e4 - samples.front().soc_e4) /
                           static_cast<double>(kSocFullE4) * capacity_wh;
  if (std::min(in_wh, out_wh) <= 10 * capacity_wh) return scale;
  scale.charge_efficiency = scale.discharge_efficiency =
      sane((stored_wh + std::sqrt(stored_wh * stored_wh + 4 * in_wh * out_wh)) / (2 * in_wh));
  return scale;
}

constexpr std::int64_t start_of(std::int64_t utc_s) {
  return utc_s / kSecondsPerQuarterHour * kSecondsPerQuarterHour;
}

/// Of the energy of one quarter-hour.
QuarterHourMoney money_of(const ExchangedDay& flow, const std::optional<SettledQuarter>& price,
                          const BatteryParameters& terms) {
  QuarterHourMoney money{.quarter_hours = 1};
  if (!price) {
    money.unpriced = 1;
    return money;
  }
  const double charged_mwh = flow.charged_wh / kWattsPerMegawatt;
  const double discharged_mwh = flow.discharged_wh / kWattsPerMegawatt;
  money.published = price->state != PriceState::kIndicative ? 1 : 0;
  money.validated = price->state == PriceState::kValidated ? 1 : 0;
  money.prices_eur_per_mwh = price->eur_per_mwh;
  // Subtraction prevents -0 on a day without exchange.
  money.earned_eur = 0.0 - (charged_mwh - discharged_mwh) * price->eur_per_mwh;
  if (money.published == 0) money.estimated_eur = money.earned_eur;
  money.contract_eur = exchange_cost_eur(terms, charged_mwh, price->eur_per_mwh) +
                       exchange_cost_eur(terms, -discharged_mwh, price->eur_per_mwh) +
                       money.earned_eur;
  return money;
}

}  // namespace

void ExchangeSample::set_written(std::int64_t price_minute_utc_s, std::int32_t price_age_s) {
  const auto after_s = static_cast<float>(price_minute_utc_s + 60 + price_age_s - utc_s) + 0.5F;
  written_after_s = after_s > 0 && after_s < kWrittenWithinS ? after_s : 0;
}

double ChargeScale::energy_wh(double moved_e4, double capacity_wh) const {
  const double charge_wh = moved_e4 / kSocFullE4 * capacity_wh;
  return charge_wh > 0 ? charge_wh / charge_efficiency : charge_wh * discharge_efficiency;
}

double ChargeScale::moved_e4(double energy_wh, double capacity_wh) const {
  const double charge_wh =
      energy_wh > 0 ? energy_wh * charge_efficiency : energy_wh / discharge_efficiency;
  return charge_wh / capacity_wh * kSocFullE4;
}

ChargeScale charge_scale_of(std::span<const ExchangeSample> samples) {
  MeasuredCharge in, out;
  std::int32_t step_e4 = INT32_MAX;
  double capacity_wh = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) {
    const ExchangeSample& from = samples[i - 1];
    const ExchangeSample& until = samples[i];
    const std::int32_t moved_e4 = until.soc_e4 - from.soc_e4;
    if (moved_e4 != 0) step_e4 = std::min(step_e4, std::abs(moved_e4));
    capacity_wh = until.capacity_wh;
    const bool is_one_order = until.utc_s - from.utc_s == kSecondsPerStep && from.is_ordered &&
                              is_close(until.power_w, from.order_w) &&
                              is_close(from.power_w, from.order_w);
    if (!is_one_order || from.order_w == 0) continue;
    MeasuredCharge& seen = from.order_w > 0 ? in : out;
    seen.energy_wh += std::fabs(until.power_w * kHoursPerStep);
    seen.charge_wh += std::abs(moved_e4) / static_cast<double>(kSocFullE4) * until.capacity_wh;
  }
  ChargeScale scale;
  if (samples.empty()) return scale;
  if (in.is_sufficient(capacity_wh)) scale.charge_efficiency = sane(in.charge_wh / in.energy_wh);
  if (out.is_sufficient(capacity_wh))
    scale.discharge_efficiency = sane(out.energy_wh / out.charge_wh);
  if (step_e4 != INT32_MAX) scale.soc_step_e4 = step_e4;
  const auto [low, high] = std::ranges::minmax(samples, {}, &ExchangeSample::soc_e4);
  scale.soc_low_e4 = low.soc_e4;
  scale.soc_high_e4 = high.soc_e4;
  return scale;
}

void for_each_exchange(std::span<const ExchangeSample> samples,
                       const std::function<void(const Exchange&)>& visit) {
  if (samples.empty()) return;
  ChargeScale scale = charge_scale_of(samples);
  constexpr int kRounds = 3;
  for (int i = 0; i < kRounds && scale.is_coarse(); ++i) scale = balanced(scale, samples);
  integrate_along(samples, scale, visit);
}

QuarterPrices::QuarterPrices(std::span<const SettledQuarter> settled) {
  for (const SettledQuarter& quarter : settled) prices_[quarter.start_utc_s].quarter = quarter;
}

void QuarterPrices::note(std::int64_t tick_utc_s, std::int64_t minute_utc_s, double eur_per_mwh) {
  // Also for the quarter-hour of the tick, in case none of its minutes arrives.
  for (const std::int64_t start_utc_s : {start_of(minute_utc_s), start_of(tick_utc_s)}) {
    const auto [at, is_new] = prices_.try_emplace(start_utc_s);
    Price& price = at->second;
    const bool is_settled = !is_new && price.quarter.state != PriceState::kIndicative;
    if (is_settled || minute_utc_s < price.minute_utc_s) continue;
    price = {minute_utc_s, {start_utc_s, eur_per_mwh, PriceState::kIndicative}};
  }
}

std::optional<SettledQuarter> QuarterPrices::find(std::int64_t utc_s) const {
  const auto found = prices_.find(start_of(utc_s));
  return found == prices_.end() ? std::nullopt : std::optional(found->second.quarter);
}

double QuarterHourMoney::mean_price_eur_per_mwh() const {
  const int priced = quarter_hours - unpriced;
  return priced == 0 ? 0 : prices_eur_per_mwh / priced;
}

void QuarterHourMoney::add(const QuarterHourMoney& other) {
  earned_eur += other.earned_eur;
  estimated_eur += other.estimated_eur;
  contract_eur += other.contract_eur;
  prices_eur_per_mwh += other.prices_eur_per_mwh;
  quarter_hours += other.quarter_hours;
  published += other.published;
  validated += other.validated;
  unpriced += other.unpriced;
}

void ExchangedDay::add(const Exchange& exchange) {
  charged_wh += exchange.charged_wh();
  discharged_wh += exchange.discharged_wh();
  if (!exchange.is_seen) unseen_wh += std::fabs(exchange.energy_wh);
}

void ExchangedDay::add(const ExchangedDay& other) {
  charged_wh += other.charged_wh;
  discharged_wh += other.discharged_wh;
  unseen_wh += other.unseen_wh;
  money.add(other.money);
}

std::map<std::int32_t, ExchangedDay> exchanged_days(std::span<const ExchangeSample> samples,
                                                    const QuarterPrices& prices,
                                                    const BatteryParameters& terms) {
  std::map<std::int32_t, ExchangedDay> days;
  std::map<std::int64_t, ExchangedDay> quarters;  // energy by start
  for_each_exchange(samples, [&](const Exchange& exchange) {
    if (!exchange.is_seen && exchange.energy_wh == 0) return;
    const auto utc_s = static_cast<std::int64_t>(exchange.from_utc_s);
    days[local_day_at(utc_s)].add(exchange);
    quarters[start_of(utc_s)].add(exchange);
  });
  for (const auto& [start_utc_s, flow] : quarters) {
    days[local_day_at(start_utc_s)].money.add(money_of(flow, prices.find(start_utc_s), terms));
  }
  return days;
}

}  // namespace bess
