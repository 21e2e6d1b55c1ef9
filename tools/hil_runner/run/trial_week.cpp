#include "tools/hil_runner/run/trial_week.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "edge/control/decision_signature.h"
#include "edge/control/safety_guard.h"
#include "shared/exchange_cost.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/run/run_picture.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/rules.h"
#include "tools/hil_runner/virtual/virtual_run.h"

namespace bess {
namespace {

constexpr int kTrialMinutes = kTrialDays * kMinutesPerDay;
constexpr double kWattHoursPerMegawattHour = 1e6;

// How strong each of them is; the paper's house gives 3 s to fetch and decide and 2 s to the
// battery.
constexpr double kDelayedRowS = 3;
constexpr std::int32_t kDelayedReplyMs = 200;  ///< of each of the ten requests of an order
constexpr double kMissingRowProbability = 0.02;
constexpr MinuteSpan kOutage{.from_min = 1 * 1'440 + 21 * 60, .to_min = 2 * 1'440 + 6 * 60};
constexpr int kColdFromHour = 2, kColdToHour = 7;  ///< local
constexpr double kColdPowerFrac = 0.6;

double cold_nights(std::int64_t utc_s) {
  const int hour = local_minute_of(utc_s).minute_of_day / 60;
  return hour >= kColdFromHour && hour < kColdToHour ? kColdPowerFrac : 1.0;
}

MinuteSeries slice(const MinuteSeries& prices, std::int64_t from_utc_s, std::int64_t to_utc_s) {
  const auto begin = std::max<std::int64_t>(0, (from_utc_s - prices.start_utc_s) / 60);
  const auto end = std::min<std::int64_t>(static_cast<std::int64_t>(prices.size()),
                                          (to_utc_s - prices.start_utc_s) / 60);
  return {.start_utc_s = prices.start_utc_s + 60 * begin,
          .indicative = {prices.indicative.begin() + begin, prices.indicative.begin() + end},
          .settled = {prices.settled.begin() + begin, prices.settled.begin() + end}};
}

/// The money of one side: minutes at their own settled price, and what is left at the end.
class Purse {
 public:
  Purse(const MinuteSeries& prices, std::int64_t start_utc_s)
      : prices_(prices), start_utc_s_(start_utc_s) {
    double sum = 0;
    for (int minute = 0; minute < kTrialMinutes; ++minute)
      sum += settled(start_utc_s + 60 * minute);
    mean_eur_per_mwh_ = sum / kTrialMinutes;
  }
  void pay(std::int64_t minute_utc_s, double energy_wh) {
    if (minute_utc_s < start_utc_s_ || minute_utc_s >= start_utc_s_ + 60 * kTrialMinutes) return;
    eur_ -= exchange_cost_eur({}, energy_wh / kWattHoursPerMegawattHour, settled(minute_utc_s));
  }
  [[nodiscard]] double eur(const BatteryParameters& battery, double soc_start,
                           double soc_end) const {
    const double left_wh =
        (soc_end - soc_start) * battery.capacity_wh * battery.discharge_efficiency;
    return eur_ + left_wh / kWattHoursPerMegawattHour * mean_eur_per_mwh_;
  }

 private:
  [[nodiscard]] double settled(std::int64_t utc_s) const {
    const double price =
        prices_.settled[static_cast<std::size_t>((utc_s - prices_.start_utc_s) / 60)];
    if (std::isnan(price)) fail("the prices hold no settled price for {}", utc_text(utc_s).view());
    return price;
  }
  const MinuteSeries& prices_;
  std::int64_t start_utc_s_;
  double mean_eur_per_mwh_ = 0;
  double eur_ = 0;
};

/// Each at any minute of its stretch.
std::vector<MinuteSpan> short_outages(int outage_min, int every_min) {
  std::mt19937_64 random(7);
  std::vector<MinuteSpan> outages;
  for (int from = 0; from < kTrialMinutes; from += every_min) {
    const int begin = from + static_cast<int>(random() % static_cast<unsigned>(every_min));
    outages.push_back({.from_min = static_cast<double>(begin),
                       .to_min = static_cast<double>(begin + outage_min)});
  }
  return outages;
}

Scenario trial_scenario(std::int64_t start_utc_s, const TrialHouse& house, const Disturbance& on) {
  Scenario scenario;
  scenario.battery.physics = house.physics;
  scenario.edge_guard = house.edge_guard;
  scenario.path = "--guard";  // the one thing of it that may be refused
  scenario.name = on.name;
  scenario.start_utc_s = start_utc_s;
  scenario.minutes = kTrialMinutes;
  scenario.battery.map = std::string(BESS_MAP_DIR) + "/alphaess.toml";
  scenario.battery.response_delay_ms = on.delay ? kDelayedReplyMs : 1;
  scenario.prices.latency_s = on.delay ? kDelayedRowS : 0;
  if (on.missing) scenario.prices.missing.push_back(kOutage);
  if (on.outages) {
    scenario.prices.missing = short_outages(house.outage_min, house.outage_every_min);
  }
  if (on.response) {
    FaultSchedule& schedule = scenario.battery_faults.emplace_back().schedule;
    schedule.faults = {BatteryFault::kSlowAndNoisy, BatteryFault::kThrottle};
    schedule.every = 1;
  }
  for (const RuleInfo& info : kRuleInfos) scenario.invariants.emplace_back(info.name);
  return scenario;
}

void lose_rows(const Scenario& scenario, double probability, MinuteSeries& prices) {
  std::mt19937_64 random(7);
  std::uniform_real_distribution<> dice(0, 1);
  for (std::size_t m = 0; m < prices.size(); ++m) {
    const double minute = static_cast<double>(prices.utc_s(m) - scenario.start_utc_s) / 60;
    const bool is_out = std::ranges::any_of(scenario.prices.missing, [&](const MinuteSpan& gap) {
      return minute >= gap.from_min && minute < gap.to_min;
    });
    if (is_out || dice(random) < probability) prices.indicative[m] = std::nan("");
  }
}

/// What one week was made of and what came of it.
struct WeekRun {
  Scenario scenario;
  MinuteSeries prices;
  EdgeConfig config;
  Evidence evidence;
};

WeekRun run_week(const MinuteSeries& prices, std::int64_t start_utc_s, const TrialHouse& house,
                 const Disturbance& on) {
  WeekRun run{.scenario = trial_scenario(start_utc_s, house, on),
              .prices = prices,
              .config = {},
              .evidence = {}};
  if (on.missing || on.outages) {
    lose_rows(run.scenario, on.missing ? kMissingRowProbability : 0, run.prices);
  }
  const WorkFolder folder;
  run.config = load_edge_settings(run.scenario, folder.file("edge.toml"),
                                  edge_settings(run.scenario, run.prices, {}));
  const bool is_chilled =
      on.temperature && !house.physics.cold.exist();  // else it knows its own hours
  run.evidence =
      run_virtual(run.scenario, run.prices, run.config, is_chilled ? cold_nights : nullptr);
  run.evidence.order_ends_by_itself = run.config.control.has_watchdog;
  run.evidence.order_duration_s = run.config.battery.map.watchdog.duration_s;
  return run;
}

double money_of(const WeekRun& run, const MinuteSeries& prices) {
  Purse purse(prices, run.scenario.start_utc_s);
  double soc_end = run.scenario.battery.soc_frac;
  for (const MinuteRecord& m : run.evidence.minutes) {
    purse.pay(m.minute_utc_s, m.energy_wh);
    if (m.minute_utc_s < run.scenario.start_utc_s + 60 * kTrialMinutes) soc_end = m.soc_frac;
  }
  return purse.eur(run.scenario.battery.physics, run.scenario.battery.soc_frac, soc_end);
}

/// Student, guard and battery model, each order in force from its tick on: nothing is late or
/// missing but what the battery's own response is.
double plain_money(const MinuteSeries& prices, std::int64_t start_utc_s,
                   BatteryParameters battery) {
  const ScenarioBattery house;
  const GuardSettings settings;
  battery.soc_min_frac = settings.soc_min_e4 / 1e4;
  battery.soc_max_frac = settings.soc_max_e4 / 1e4;
  SafetyGuard guard(settings);
  PriceLevel level = PriceLevel::starting_at(level_before(prices, start_utc_s).centi_eur_per_mwh());
  Purse purse(prices, start_utc_s);
  double soc = house.soc_frac;
  PowerState power;
  for (int minute = 0; minute < kTrialMinutes; minute += kMinutesPerStep) {
    const std::int64_t now_utc_s = start_utc_s + 60 * minute;
    const auto newest = static_cast<std::size_t>((now_utc_s - 60 - prices.start_utc_s) / 60);
    const auto centi = static_cast<std::int32_t>(std::lround(100 * prices.indicative[newest]));
    level.observe(now_utc_s - 60, centi);
    const GuardInputs in =
        undisturbed_inputs(now_utc_s, static_cast<std::int32_t>(std::lround(1e4 * soc)),
                           level.centi_eur_per_mwh(), now_utc_s - 60, centi);
    const double most_w = battery.power_w_at(local_minute_of(now_utc_s).quarter_hour);
    const double wanted_w = std::clamp<double>(guard.decide(in).power_w, -most_w, most_w);
    const FollowedStep moved = followed_step(battery, soc, power, wanted_w, kHoursPerStep);
    soc = moved.step.soc_frac;
    power = moved.power;
    const double minute_wh = (moved.step.power_w + battery.standby_w) / 60;
    for (int m = 0; m < kMinutesPerStep; ++m) purse.pay(now_utc_s + 60 * m, minute_wh);
  }
  return purse.eur(battery, house.soc_frac, soc);
}

/// Midnights, UTC, at which eight days begin that the file holds whole, with three days before
/// them.
std::vector<std::int64_t> week_starts(const MinuteSeries& prices) {
  constexpr std::int64_t kDayS = 86'400;
  std::vector<std::int64_t> starts;
  const std::int64_t end_utc_s = prices.start_utc_s + 60 * static_cast<std::int64_t>(prices.size());
  std::int64_t start = (prices.start_utc_s + 3 * kDayS + kDayS - 1) / kDayS * kDayS;
  for (; start + kTrialDays * kDayS <= end_utc_s; start += kTrialDays * kDayS)
    starts.push_back(start);
  return starts;
}

MinuteSeries week_prices(const MinuteSeries& prices, std::int64_t start_utc_s) {
  return slice(prices, start_utc_s - 4 * 86'400, start_utc_s + 60 * kTrialMinutes);
}

}  // namespace

const std::array<Disturbance, kDisturbanceCount>& disturbances() {
  static constexpr std::array<Disturbance, kDisturbanceCount> kAll = {{
      {.name = "loop", .text = "the loop alone: rows at once, replies after 1 ms"},
      {.name = "delay",
       .text = "rows 3 s after their minute, each reply after 200 ms",
       .delay = true},
      {.name = "missing",
       .text = "2 % of the rows never come, and nine hours of one night",
       .missing = true},
      {.name = "outages",
       .text = "no rows now and then: --outage-min in each --outage-every-min",
       .outages = true},
      {.name = "temperature",
       .text = "0.6 of the power from 2 to 7 o'clock, as the battery shows",
       .temperature = true},
      {.name = "response",
       .text = "orders show 5 s later with 2 % noise, a quarter of the power within 5 % of a limit",
       .response = true},
      {.name = "together",
       .text = "all but outages",
       .delay = true,
       .missing = true,
       .temperature = true,
       .response = true},
  }};
  return kAll;
}

BatteryParameters paper_house() { return ScenarioBattery{}.physics; }

std::vector<TrialWeek> run_trial(const MinuteSeries& prices, int weeks, const TrialHouse& house,
                                 const std::function<void(int, int)>& tell) {
  const std::vector<std::int64_t> starts = week_starts(prices);
  if (std::ssize(starts) < weeks) {
    fail("the prices hold {} times {} days, {} were asked for (--weeks)", starts.size(), kTrialDays,
         weeks);
  }
  std::vector<TrialWeek> done;
  for (const std::int64_t start_utc_s : starts) {
    if (std::ssize(done) == weeks) break;
    const MinuteSeries own = week_prices(prices, start_utc_s);
    TrialWeek week;
    week.start_utc_s = start_utc_s;
    week.plain_eur = plain_money(own, start_utc_s, house.physics);
    for (std::size_t i = 0; i < disturbances().size(); ++i) {
      const WeekRun run = run_week(own, start_utc_s, house, disturbances()[i]);
      week.loop_eur[i] = money_of(run, own);
      std::ranges::move(judge({run.scenario, run.prices, run.config, run.evidence}),
                        std::back_inserter(week.findings));
    }
    done.push_back(std::move(week));
    tell(static_cast<int>(done.size()), weeks);
  }
  return done;
}

TrialLoss loss_of(const std::vector<TrialWeek>& weeks, std::size_t disturbance) {
  const auto n = static_cast<double>(weeks.size());
  double plain = 0, lost = 0, squares = 0;
  for (const TrialWeek& week : weeks) {
    const double difference = week.plain_eur - week.loop_eur[disturbance];
    plain += week.plain_eur;
    lost += difference;
    squares += difference * difference;
  }
  const double variance = n > 1 ? (squares - lost * lost / n) / (n - 1) : 0;
  return {.percent = 100 * lost / plain,
          .percent_error = 100 * std::sqrt(variance / n) / (plain / n)};
}

std::string trial_picture(const MinuteSeries& prices, const TrialHouse& house) {
  constexpr int kPictureMinutes = 240;
  const std::int64_t start_utc_s = week_starts(prices).at(0);
  const MinuteSeries own = week_prices(prices, start_utc_s);
  const WeekRun run = run_week(own, start_utc_s, house, disturbances().back());
  std::int64_t widest_utc_s = start_utc_s;
  double widest = -1;
  for (int minute = 0; minute + kPictureMinutes <= kTrialMinutes; minute += 60) {
    const auto first = own.indicative.begin() + (start_utc_s - own.start_utc_s) / 60 + minute;
    const auto [low, high] = std::minmax_element(first, first + kPictureMinutes);
    if (*high - *low <= widest) continue;
    widest = *high - *low;
    widest_utc_s = start_utc_s + 60 * minute;
  }
  return orders_picture(run.evidence, own, widest_utc_s);
}

}  // namespace bess
