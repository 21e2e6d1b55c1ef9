// Fleet in the simulated market: without impact it is bit-identical to the existing environment;
// with impact prices follow by hand, are seen when they are published, and nothing looks ahead.
#include "workstation/runs/impact/fleet_market.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "shared/local_time.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/market/model/simulated_market.h"
#include "workstation/data/market/series/local_date.h"
#include "workstation/runs/impact/impact_study.h"

namespace bess {
namespace {

constexpr LocalDate kFirstDay{2023, 3, 20};  // the clocks change on the 26th

std::int64_t start_utc_s() {
  set_market_time_zone();
  return local_midnight_utc_s(kFirstDay);
}

/// Existing environment: the simulated market's minute file, and the policy evaluated on it; at the
/// longest delay with a battery with losses, taper, response, standby and a limit on full cycles.
TEST(FleetMarket, OneBatteryWithoutImpactIsTodaysEnvironmentToTheBit) {
  for (const int delay_min : {1, 2, 5}) {
    const DrawnMarket drawn = draw_market(start_utc_s(), 12, 5);
    const std::int64_t end_utc_s = drawn.quarter_hours.back().utc_s + 900;
    const MinuteSeries series =
        minutes_on_quarter_hours(simulate_quarter_hours({start_utc_s(), end_utc_s}, 5), 5);
    const MarketSteps market = make_market_steps(series, {.observation_delay_min = delay_min});
    FleetOptions options{.battery = {}, .observation_delay_min = delay_min};
    options.battery.wear_eur_per_mwh = 5;
    options.battery.costs.export_percent = 3;
    if (delay_min == 5) {
      options.battery.charge_taper = {.width_frac = 0.2, .share = 0.3};
      options.battery.full_power_loss_frac = 0.02;
      options.battery.standby_w = 20'000;
      options.battery.response = {.delay_s = 4, .ramp_w_per_s = 5e4, .time_constant_s = 6};
      options.battery.cycles_per_day_max = 2.5;
    }
    const auto policy = fitted_policy("sdp", series, options);
    const Evaluation today = evaluate(market, market.days, *policy, {options.battery, 0.5, true});

    const FleetRun run = run_fleet(drawn, {{policy, 1}}, options);
    EXPECT_EQ(run.prices.start_utc_s, series.start_utc_s);
    EXPECT_EQ(run.prices.indicative, series.indicative);
    EXPECT_EQ(run.prices.settled, series.settled);
    ASSERT_EQ(today.days.size(), 12U);
    ASSERT_EQ(run.parts[0].days.size(), 12U);
    for (std::size_t d = 0; d < 12; ++d) {
      const DayResult& here = run.parts[0].days[d];
      EXPECT_EQ(here.date, today.days[d].date);
      EXPECT_EQ(here.profit_eur, today.days[d].profit_eur) << here.date;
      EXPECT_EQ(here.soc_end_frac, today.days[d].soc_end_frac);
      EXPECT_EQ(here.soc_start_frac, today.days[d].soc_start_frac);
      EXPECT_EQ(here.switches, today.days[d].switches);
      EXPECT_EQ(here.cycles, today.days[d].cycles);
    }
  }
}

/// A shortage of 200 MW, bids of 180 up and 20 down.
MinutePath flat_path(double imbalance_mw) {
  MinutePath path{};
  path.imbalance_mw.fill(imbalance_mw);
  path.incremental_eur_per_mwh.fill(180);
  path.decremental_eur_per_mwh.fill(20);
  path.previous_imbalance_mw = imbalance_mw;
  return path;
}

double price(PriceFormula formula, double imbalance_mw, double fleet_mw) {
  return fleet_price(formula, flat_path(imbalance_mw), 7, imbalance_mw < 0, fleet_mw, 0);
}

TEST(FleetMarket, PricesByHandOfThreeFormulas) {
  const auto alpha = [](double now_mw, double before_mw) {
    return 200 / (1 + std::exp((450 - (now_mw + before_mw) / 2) / 65));
  };
  using enum PriceFormula;
  EXPECT_NEAR(price(kMarginal, -200, 0), 180 + alpha(200, 200), 0.006);
  EXPECT_NEAR(price(kMarginal, -200, 80), 180 - 0.19 * 80, 0.006) << "alpha ends at 150 MW";
  EXPECT_NEAR(price(kMarginal, -200, -80), 180 + 0.19 * 80 + alpha(280, 200), 0.006);
  EXPECT_NEAR(price(kMarginal, -200, 300), 20 - 0.28 * 100, 0.006) << "turned to the other side";
  // The first bids are 180 - 38 = 142 up and 20 down.
  EXPECT_NEAR(price(kMean, -200, 0), (142 + 180) / 2.0, 0.006);
  EXPECT_NEAR(price(kMean, -200, 100), (142 + 161) / 2.0, 0.006);
  EXPECT_NEAR(price(kMean, -200, 180), (142 + 20) / 2.0, 0.006) << "dead band";
  EXPECT_NEAR(price(kMean, -200, 300), (20 + 20 - 28) / 2.0, 0.006);
  EXPECT_NEAR(price(kMeanWithAlpha, -200, 0), 161 + alpha(200, 200), 0.006);
  EXPECT_NEAR(price(kMeanWithAlpha, 200, 0), (20 + 76) / 2.0 - alpha(200, 200), 0.006);
  EXPECT_NEAR(price(kMeanWithAlpha, 200, -180), (180 + 76) / 2.0, 0.006);
}

/// Discharges from `from_min` on, and stores its observations.
class Probe final : public Policy {
 public:
  explicit Probe(std::int64_t from_utc_s) : from_utc_s_(from_utc_s) {}
  [[nodiscard]] Action decide(const MarketStep& step, std::size_t, double) const override {
    seen.push_back(step);
    return step.utc_s >= from_utc_s_ ? Action::kDischarge : Action::kIdle;
  }
  mutable std::vector<MarketStep> seen;

 private:
  std::int64_t from_utc_s_;
};

DrawnMarket one_day() { return draw_market(start_utc_s(), 1, 3); }

/// Its discharge from 01:02 on is first in the row of 01:02, which a delay of 2 shows at 01:04.
TEST(FleetMarket, TheFleetSeesWhatItDidWhenThatIsPublished) {
  FleetOptions options{.battery = {}, .observation_delay_min = 2};
  const auto quiet = std::make_shared<Probe>(INT64_MAX);
  (void)run_fleet(one_day(), {{quiet, 1}}, options);
  options.fleet_mw = 300;
  const auto loud = std::make_shared<Probe>(start_utc_s() + 62 * 60);
  const FleetRun run = run_fleet(one_day(), {{loud, 1}}, options);
  ASSERT_EQ(quiet->seen.size(), loud->seen.size());
  const auto differs =
      std::ranges::mismatch(quiet->seen, loud->seen, {}, &MarketStep::observed_eur_per_mwh,
                            &MarketStep::observed_eur_per_mwh);
  ASSERT_NE(differs.in1, quiet->seen.end());
  EXPECT_EQ(differs.in1->utc_s, start_utc_s() + 64 * 60);
  EXPECT_LT(differs.in2->observed_eur_per_mwh, differs.in1->observed_eur_per_mwh);
  EXPECT_EQ(differs.in2->observed_age_min, 2);
  // 13 of 15 minutes with 300 MW more.
  EXPECT_NEAR(run.imbalance_mw[4] - one_day().paths[4].imbalance_mw.back(), 300 * 13 / 15.0, 1e-9);
}

/// Half of the fleet decides in odd minutes; in the other half an order may change by a quarter.
TEST(FleetMarket, ClocksAreLateAndStepsAreSmall) {
  FleetOptions options{.battery = {}, .fleet_mw = 100};
  const auto late = std::make_shared<Probe>(0);
  const auto later = std::make_shared<Probe>(INT64_MAX);
  const FleetRun run = run_fleet(one_day(), {{late, 0.5, 1, 0.25}, {later, 0.5, 4, 2}}, options);
  EXPECT_EQ(late->seen[0].utc_s, start_utc_s() + 60);
  EXPECT_EQ(late->seen[0].observed_age_min, 1);
  EXPECT_EQ(later->seen[0].utc_s, start_utc_s() + 6 * 60) << "nothing was published before";
  EXPECT_EQ(later->seen[0].observed_age_min, 5);
  // Discharged from minute 1 on, in steps: 1/4 1/4 1/2 1/2 3/4 3/4 and then all, of half the fleet.
  const double given_mw = 50 * (2 * (0.25 + 0.5 + 0.75) + 8) / 15;
  EXPECT_NEAR(run.imbalance_mw[0] - one_day().paths[0].imbalance_mw.back(), given_mw, 1e-9);
}

/// Reversing later quarter-hours changes no earlier decision.
TEST(FleetMarket, NothingLooksAhead) {
  DrawnMarket market = draw_market(start_utc_s(), 6, 9);
  FleetOptions options{.battery = {}, .fleet_mw = 200};
  const auto policy = fitted_policy("sdp", run_fleet(market, {}, options).prices, options);
  const FleetRun before = run_fleet(market, {{policy, 0.5}, {policy, 0.5, 1}}, options);
  const std::size_t from = 3 * 96;
  for (std::size_t q = from; q < market.paths.size(); ++q) {
    for (double& mw : market.paths[q].imbalance_mw) mw = -mw;
  }
  const FleetRun after = run_fleet(market, {{policy, 0.5}, {policy, 0.5, 1}}, options);
  const auto minutes = static_cast<std::ptrdiff_t>(from * 15);
  EXPECT_TRUE(std::equal(before.prices.indicative.begin(),
                         before.prices.indicative.begin() + minutes,
                         after.prices.indicative.begin()));
  EXPECT_NE(before.prices.indicative[from * 15], after.prices.indicative[from * 15]);
  for (std::size_t part = 0; part < 2; ++part) {
    for (std::size_t day = 0; day < 2; ++day) {
      EXPECT_EQ(before.parts[part].days[day].profit_eur, after.parts[part].days[day].profit_eur);
    }
  }
}

TEST(ImpactStudy, RowsAreMeansOverSeedsAndAShyFleetTradesLess) {
  ImpactPlan plan{.fleet_mw = {0, 600},
                  .policies = {"rbc", "sdp"},
                  .train_days = 10,
                  .test_days = 3,
                  .seeds = 2,
                  .rounds = 1,
                  .threads = 2};
  const std::vector<ImpactRow> rows = study_impact(plan, {.battery = {}});
  ASSERT_EQ(rows.size(), 3U * 2 * 5);
  const auto row_of = [&](double mw, const char* variant) -> const ImpactRow& {
    return *std::ranges::find_if(
        rows, [&](const ImpactRow& row) { return row.fleet_mw == mw && row.variant == variant; });
  };
  const ImpactRow& alone = row_of(0, "as it is");
  EXPECT_EQ(alone.overshoot_share, 0);
  EXPECT_EQ(alone.imbalance_mw, alone.imbalance_alone_mw);
  EXPECT_EQ(row_of(0, "round 1").eur_per_mw_day, alone.eur_per_mw_day)
      << "its own prices are those of the environment";
  EXPECT_GT(alone.eur_per_mw_day, row_of(600, "as it is").eur_per_mw_day);
  EXPECT_GT(row_of(600, "as it is").overshoot_share, 0.1);
  EXPECT_GT(row_of(600, "shy").eur_per_mw_day, row_of(600, "as it is").eur_per_mw_day);
  EXPECT_LT(row_of(600, "shy").switches_per_day, row_of(600, "as it is").switches_per_day);
  plan.seeds = 1;
  const std::vector<ImpactRow> first = study_impact(plan, {.battery = {}});
  EXPECT_TRUE(std::isnan(first[0].standard_error));
  // Of two seeds the error is half of their difference.
  EXPECT_NEAR(std::fabs(first[0].eur_per_mw_day - rows[0].eur_per_mw_day), rows[0].standard_error,
              1e-6);
}

}  // namespace
}  // namespace bess
