#include "tests/system/trial/trial_run.h"

#include <algorithm>
#include <cmath>

#include "shared/local_time.h"

namespace bess::trial {
namespace {

constexpr std::int32_t kDearCentiEur = 160'000;
constexpr std::int32_t kCheapCentiEur = -60'000;
constexpr std::int64_t kDayS = 86'400;
/// Day of the benchmark on which the trial begins: 1 February 2023.
constexpr std::int64_t kFirstDay = 31;

bool charges_at(Orders orders, std::int64_t cycle) {
  switch (orders) {
    case Orders::kCharge:
      return true;
    case Orders::kAlternating:
      return cycle % 2 == 0;
    case Orders::kPairs:
      return cycle / 2 % 2 == 0;
    case Orders::kHours:
      return cycle / 20 % 2 == 0;
    case Orders::kDischarge:
    case Orders::kZero:
    case Orders::kRealDay:
      break;
  }
  return false;
}

std::int32_t real_price_centi(std::int64_t minute_utc_s) {
  const MinuteSeries& prices = real_prices();
  const std::int64_t minute = (minute_utc_s - prices.start_utc_s) / 60;
  const double price = prices.indicative[static_cast<std::size_t>(minute)];
  return std::isnan(price) ? 0 : static_cast<std::int32_t>(std::lround(price * 100));
}

}  // namespace

std::string_view orders_name(Orders orders) {
  constexpr std::string_view kNames[] = {"charge", "discharge", "0 W",  "alternating",
                                         "pairs",  "real day",  "hours"};
  return kNames[static_cast<int>(orders)];
}

TrialSite::TrialSite(const BatteryNature& nature, double soc_frac, const ControlSettings& settings,
                     std::uint64_t seed)
    : clock{.now_ns = (real_prices().start_utc_s + kFirstDay * kDayS) * kNanosecondsPerSecond},
      battery(clock, nature, soc_frac, seed),
      settings_(settings) {
  start();
}

void TrialSite::start() {
  loop_.emplace(settings_, battery, prices, clock);
  loop_->follow_holds(holds);
}

void TrialSite::kill_and_restart() {
  clock.pause_ns(45 * kNanosecondsPerSecond);
  start();
  recall_cycles(log_, clock.now_utc_s(), *loop_);
  const CycleRecord& newest = log_.records.back();
  loop_->take_over(take_over_of(newest, newest.price_level),
                   newest.is_tripped ? std::optional(newest.trip) : std::nullopt);
}

void TrialSite::step_clock() {
  // Sum zero: days of one price stay days of one price.
  constexpr std::int64_t kStepsS[] = {1,    -1,    30,     -30, 119, -119,   600,
                                      -600, 3'600, -3'600, -2,  45,  -3'000, 2'957};
  const std::int64_t step_s = kStepsS[clock_steps_ % std::size(kStepsS)];
  clock.step_after(static_cast<std::int64_t>(clock_steps_ * 37 % 110), step_s);
  ++clock_steps_;
}

std::int64_t TrialSite::next_tick_utc_s() const { return bess::next_tick_utc_s(clock.now_utc_s()); }

CycleRecord TrialSite::cycle(Orders orders) {
  if (orders == Orders::kZero) return cycle_held(0);
  holds.publish({});
  prices.price_centi_eur_per_mwh =
      orders == Orders::kRealDay ? real_price_centi(next_tick_utc_s() - 60)
                                 : (charges_at(orders, cycles_) ? kCheapCentiEur : kDearCentiEur);
  return run();
}

CycleRecord TrialSite::cycle_held(std::int32_t power_w) {
  holds.publish(
      {.power_w = power_w, .until_utc_s = static_cast<std::uint32_t>(next_tick_utc_s() + 600)});
  return run();
}

CycleRecord TrialSite::run() {
  ++cycles_;
  CycleRecord record;
  loop_->run_cycle(record);
  log_.records.push_back(record);
  if (log_.records.size() > TrialLog::kRecordsMax) log_.records.pop_front();
  return record;
}

ControlSettings trial_settings(const HonestVariant& variant) {
  const BatteryNature& nature = variant.nature;
  ControlSettings settings;
  settings.control = true;
  settings.has_watchdog = true;
  settings.guard.power_w = static_cast<std::int32_t>(nature.rated_w);
  settings.supervision.response.power_w = settings.guard.power_w;
  settings.supervision.response.capacity_wh = static_cast<std::int32_t>(nature.shown_capacity_wh);
  settings.supervision.response.band.charges_by_itself = variant.charges_by_itself;
  settings.supervision.response.band.settle_s = variant.map_settle_s;
  settings.supervision.response.band.soc_refresh_s = variant.map_soc_refresh_s;
  settings.supervision.response.band.soc_step_e4 =
      variant.map_soc_step_e4 > 0 ? variant.map_soc_step_e4 : nature.soc_step_e4;
  return settings;
}

namespace {

void note_reported(const ResponseFindings& findings, FaultResult& result) {
  if (findings.energy_share_percent == 0 && findings.rest_loss_w == 0) return;
  if (result.reported_cycles == 0) result.reported_cycles = result.cycles;
  result.reported = findings;
}

/// Days of alternating orders end at the floor by losses alone, where a fault has little to move.
Orders orders_at(const TrialSite& site, const FaultCase& c, bool& recharges) {
  const bool drifts = c.orders == Orders::kAlternating || c.orders == Orders::kPairs;
  if (c.cycles_max == 0 || !drifts) return c.orders;
  const double soc_frac = site.battery.charge_frac();
  if (soc_frac < 0.2) recharges = true;
  if (soc_frac > 0.6) recharges = false;
  return recharges ? Orders::kCharge : c.orders;
}

}  // namespace

FaultResult try_fault(const FaultCase& c) {
  ControlSettings settings = trial_settings({.name = "", .nature = {}});
  if (c.orders != Orders::kRealDay) settings.reversals_per_hour_max = 0;
  if (c.cycles_max > 0) settings.frozen_price = {.frozen_s = 0, .stop_s = 0};  // of two, for days
  TrialSite site({}, c.soc_frac, settings, 1);
  // In balance, so that the fault begins at the intended charge.
  for (int i = 0; i < 3; ++i) site.cycle(Orders::kZero);
  if (c.soc_frac > 0.2) {
    for (int i = 0; i < 2; ++i) site.cycle(i == 0 ? Orders::kDischarge : Orders::kCharge);
  }
  // Until a battery has reversed, its power belongs to the previous order.
  constexpr std::int64_t kReversedS = 10;
  const std::int64_t begin_s = c.cycles_max > 0 ? kReversedS : 0;
  site.battery.begin_fault(*c.fault, c.times, site.next_tick_utc_s() + begin_s);
  const EnergyAccount before = site.battery.energy();
  FaultResult result;
  bool recharges = false;
  const int cycles_max = c.cycles_max > 0 ? c.cycles_max : fault_cycles_max(c.orders);
  while (result.reason == Reason::kStudent && result.cycles < cycles_max) {
    const CycleRecord record = site.cycle(orders_at(site, c, recharges));
    ++result.cycles;
    result.weak_answers = std::max(result.weak_answers, record.weak_answers);
    note_reported(record.findings, result);
    const double wrong_wh = site.battery.energy().wrong_wh - before.wrong_wh;
    const bool is_reported = record.findings.wrong_energy_e6 >= WrongEnergy::kReportedE6;
    if (is_reported && result.wrong_until_reported_wh == 0)
      result.wrong_until_reported_wh = wrong_wh;
    // For days: through the pauses.
    const bool ends = c.cycles_max > 0 ? record.is_tripped : is_stop_reason(record.reason);
    if (ends) result.reason = record.reason;
    result.is_trip = record.is_tripped;
    if (c.is_killed) site.kill_and_restart();
    if (c.step_every > 0 && result.cycles % c.step_every == 0) site.step_clock();
  }
  result.wrong_wh = site.battery.energy().wrong_wh - before.wrong_wh;
  if (result.reason == Reason::kStudent) return result;
  for (int i = 0; i < kCyclesAfter; ++i) {
    result.driven_after += site.cycle(c.orders).ordered_power_w != 0 ? 1 : 0;
  }
  return result;
}

/// Real prices, but full by night and empty in the evening, each with two hours of rest.
CycleRecord cycle_of_day(TrialSite& site, std::int32_t night_charge_power_w) {
  const std::int64_t minute = site.next_tick_utc_s() / 60 % (24 * 60);
  const auto is_between = [&](int from, int to) { return minute >= from && minute < to; };
  if (is_between(60, 240)) return site.cycle_held(night_charge_power_w);
  if (is_between(240, 360) || is_between(1'110, 1'230)) return site.cycle(Orders::kZero);
  return site.cycle(is_between(1'020, 1'110) ? Orders::kDischarge : Orders::kRealDay);
}

HonestDays live_honest_days(const HonestVariant& variant, int days, const Disturbances& often) {
  TrialSite site(variant.nature, 0.5, trial_settings(variant), 1);
  HonestDays result;
  for (int i = 0; i < days * kStepsPerDay; ++i) {
    const CycleRecord record = cycle_of_day(site, variant.night_charge_power_w);
    ++result.cycles;
    result.driven += record.ordered_power_w != 0 ? 1 : 0;
    result.wrong_energy_e6_max =
        std::max(result.wrong_energy_e6_max, record.findings.wrong_energy_e6);
    if (often.kill_every > 0 && (i + 1) % often.kill_every == 0) site.kill_and_restart();
    if (often.step_every > 0 && (i + 1) % often.step_every == 0) site.step_clock();
    if (!record.is_tripped) continue;
    if (result.trips++ == 0) {
      result.first_trip = record.trip.reason;
      result.first_trip_cycle = i;
    }
    site.clear_trip();
  }
  result.moved_wh = site.battery.energy().moved_wh;
  return result;
}

const MinuteSeries& real_prices() {
  static const MinuteSeries prices = [] {
    set_market_time_zone();
    return read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  }();
  return prices;
}

}  // namespace bess::trial
