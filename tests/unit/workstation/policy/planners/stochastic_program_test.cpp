// Stochastic program: it reaches the figures of the prototypes [SPEC 8] and uses its information.
#include "workstation/policy/planners/stochastic_program.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "shared/host/user_error.h"
#include "tests/support/market_series.h"
#include "tests/support/small_market.h"

namespace bess {
namespace {

double profit(const MarketSteps& market, bool carry_soc, double level_weight) {
  StochasticProgramPolicy policy(market, market.days_of(Split::kTrain), {}, level_weight);
  return evaluate(market, market.days_of(Split::kValidation), policy,
                  {.battery = {}, .carry_soc = carry_soc})
      .profit_eur_per_day_per_mwh();
}

TEST(StochasticProgram, EarnsOnTheBenchmarkWhatThePrototypesEarn) {
  const MarketSteps market = make_market_steps(read_benchmark(), {});
  // By hour alone, as the prototype; by level at least as much: each level has its values.
  EXPECT_NEAR(profit(market, false, 0), 464.6, 6);
  EXPECT_NEAR(profit(market, true, 0), 450.9, 6);
  EXPECT_GT(profit(market, false, 0.6), 491.7);
  EXPECT_GT(profit(market, true, 0.6), 481.5);
}

TEST(StochasticProgram, EnergyIsWorthLessTheMoreThereIsOfIt) {
  const StochasticProgram program(small_steps(), small_steps().days_of(Split::kTrain), {});
  constexpr int kPoints = StochasticProgram::kSocPoints;
  const SocGrid grid(BatteryParameters{}, kPoints);
  for (std::size_t i = 0; i < small_steps().steps.size(); i += 997) {
    float value[kPoints];
    const auto at = StochasticProgram::market_state_of(small_steps().steps[i]);
    for (int p = 0; p < kPoints; ++p) {
      const auto worth = program.action_values(at, grid.at(p));
      value[p] = static_cast<float>(*std::ranges::max_element(worth));
    }
    for (int p = 2; p < kPoints; ++p) {
      const float concave = value[p] - 2 * value[p - 1] + value[p - 2];
      EXPECT_LT(concave, 0.01F * std::fabs(value[kPoints - 1] - value[0])) << i << ' ' << p;
    }
  }
}

TEST(StochasticProgram, DoesNotBuyAboveWhatIsUsualAtTheLevel) {
  const StochasticProgram program(small_steps(), small_steps().days_of(Split::kTrain), {});
  StochasticProgram::MarketState at =
      StochasticProgram::market_state_of(small_steps().steps[5'000]);
  const auto best = [&] { return argmax_action(program.action_values(at, 0.5).data()); };
  at.price_eur_per_mwh = at.level_eur_per_mwh - 400;
  EXPECT_EQ(best(), Action::kCharge);
  at.price_eur_per_mwh = at.level_eur_per_mwh + 400;
  EXPECT_EQ(best(), Action::kDischarge);
}

TEST(StochasticProgram, UsesTheRowsQuarterHour) {
  for (const int delay : {0, 1, 2}) {
    const MarketSteps market = make_market_steps(small_series(), {.observation_delay_min = delay});
    const StochasticProgram program(market, market.days_of(Split::kTrain), {});
    for (int minute = 0; minute < kMinutesPerQuarterHour; ++minute) {
      EXPECT_EQ(program.row_quarter_hour(40, minute), minute < delay ? 39 : 40) << delay << minute;
      EXPECT_EQ(program.row_quarter_hour(0, minute), minute < delay ? 95 : 0);
    }
  }
}

TEST(StochasticProgram, NothingToFitOnIsAnError) {
  EXPECT_THROW(StochasticProgram(small_steps(), {}, {}), UserError);
}

}  // namespace
}  // namespace bess
