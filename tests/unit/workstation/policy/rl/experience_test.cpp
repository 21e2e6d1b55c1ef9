#include "shared/battery_model.h"
#include "workstation/policy/planners/stochastic_program.h"
#include "workstation/policy/rl/train.h"

#include <set>

#include "tests/unit/workstation/policy/rl/market_by_hand.h"

namespace bess {
namespace {

constexpr double kSocTolerance = 1e-9;
constexpr double kRewardTolerance = 1e-6;

// ---- One transition by hand -----------------------------------------------------------------

/// One training day of one step without a successor, or of two.
MarketSteps one_day(Horizon horizon) {
  return market_by_hand(
      {{Split::kTrain, horizon == Horizon::kDay ? std::vector<int>{0} : std::vector<int>{0, 1}}});
}

constexpr Horizon kOn = Horizon::kContinuing;
constexpr Horizon kEnd = Horizon::kDay;

// Battery of the paper: 4 MW, 8 MWh, sqrt(0.9) each way. A step of 1/30 h at full power moves
// 0.0158113883 up or 0.0175682092 down. Step 0 is paid 100 EUR/MWh: 400 EUR/h, 0.04 scaled.
TEST(Transitions, RewardAndSocByHand) {
  const struct {
    const char* name;
    Action action;
    double soc;
    Horizon horizon;
    double soc_after, reward;
  } cases[] = {
      {"charge", Action::kCharge, 0.5, kOn, 0.5158113883, -0.04},
      {"idle", Action::kIdle, 0.5, kOn, 0.5, 0},
      {"discharge", Action::kDischarge, 0.5, kOn, 0.4824317908, 0.04},
      // 0.005 * 8 MWh = 40 kWh still fit: 40 kWh / sqrt(0.9) * 30 / h = 1.2649 MW
      {"nearly full", Action::kCharge, 0.995, kOn, 1, -0.0126491106},
      {"full", Action::kCharge, 1, kOn, 1, 0},
      {"nearly empty", Action::kDischarge, 0.105, kOn, 0.1, 0.0113841996},
      {"empty", Action::kDischarge, 0.1, kOn, 0.1, 0},
      {"below the window", Action::kDischarge, 0.05, kOn, 0.05, 0},
      {"terminal", Action::kCharge, 0.5, kEnd, 0.5158113883, -0.04},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const TrainingMarket market(one_day(c.horizon), straight_price_map(), {}, c.horizon, {});
    ASSERT_EQ(market.step_count(), 1u);
    Transition t{};
    EXPECT_NEAR(market.make_transition(0, c.soc, c.action, t), c.soc_after, kSocTolerance);
    EXPECT_EQ(t.action, static_cast<int>(c.action));
    EXPECT_EQ(t.terminal, c.horizon == Horizon::kDay ? 1 : 0);
    EXPECT_NEAR(t.reward, c.reward, kRewardTolerance);
    EXPECT_EQ(t.state[3], scaled_soc(c.soc));
    EXPECT_NEAR(t.next_state[3], scaled_soc(c.soc_after), 1e-6);
  }
}

TEST(Transitions, RewardsAreThoseOfThePaperWhateverTheSize) {
  BatteryParameters small;
  small.power_w_max = 25e3;
  small.capacity_wh = 100e3;  // four hours
  const TrainingMarket market(one_day(kOn), straight_price_map(), small, kOn, {});
  Transition t{};
  const double soc = market.make_transition(0, 0.5, Action::kCharge, t);
  EXPECT_NEAR(soc, 0.5 + 0.0158113883 / 2, kSocTolerance);
  EXPECT_NEAR(t.reward, -0.04, kRewardTolerance);
}

/// A battery with costs that differ between taking and giving, at prices on both sides of zero.
TEST(Transitions, RewardsAreTheMoneyOfTheAccounting) {
  MarketSteps steps = uneven_market();
  for (std::size_t k = 0; k < steps.steps.size(); ++k) {
    steps.steps[k].paid_eur_per_mwh = (k % 2 == 0 ? 1 : -1) * (10.0 + static_cast<double>(k));
  }
  BatteryParameters battery;
  battery.wear_eur_per_mwh = 6;
  battery.costs = {40, 5, 3, 2};
  const TrainingMarket market(steps, straight_price_map(), battery, kOn, {});
  Random random(72);
  for (int draw = 0; draw < 3000; ++draw) {
    const std::size_t index = random.index(market.step_count());
    const double soc = market.draw_soc(random);
    const auto action = static_cast<Action>(random.index(kActionCount));
    Transition t{};
    const double after = market.make_transition(index, soc, action, t);
    const MarketStep& step = steps.steps[static_cast<std::size_t>(step_of_input(t.state[4]))];
    const BatteryStep moved = battery_step(battery, soc, power_sign(action) * 4e6, 2.0 / 60);
    EXPECT_DOUBLE_EQ(after, moved.soc_frac);
    ASSERT_TRUE(soc >= battery.soc_min_frac && soc <= battery.soc_max_frac);
    const double cost_eur =
        exchange_cost_eur(battery, moved.power_w / 1e6 / 30, step.paid_eur_per_mwh);
    ASSERT_NEAR(t.reward, -cost_eur * 30 / 1e4, 1e-7);  // EUR per step -> 1e4 EUR/h
  }
}

// ---- Transitions ------------------------------------------------------------

/// Pairs of the steps from each first to its last, and a terminal one where the day ends.
std::vector<std::pair<int, int>> blocks(const std::vector<std::pair<int, int>>& of, bool terminal) {
  std::vector<std::pair<int, int>> pairs;
  for (const auto& [first, last] : of) {
    for (int step = first; step < last; ++step) pairs.emplace_back(step, step + 1);
    if (terminal && last != 17) pairs.emplace_back(last, -1);  // a gap in the day follows 17
  }
  return pairs;
}

TEST(Successors, AreTheNextTrainingStepOrNone) {
  const struct {
    Horizon horizon;
    std::vector<std::pair<int, int>> from_to;  ///< steps of state and successor, -1 = terminal
    std::vector<std::size_t> day_counts;
  } cases[] = {
      {kOn, blocks({{0, 7}, {12, 15}, {16, 17}, {18, 19}}, false), {4, 3, 3, 2}},
      {kEnd, blocks({{0, 3}, {4, 7}, {12, 15}, {16, 17}, {18, 19}}, true), {4, 4, 4, 3}},
  };
  const MarketSteps steps = uneven_market();
  for (const auto& c : cases) {
    const TrainingMarket market(steps, straight_price_map(), {}, c.horizon, {});
    ASSERT_EQ(market.step_count(), c.from_to.size());
    for (std::size_t i = 0; i < market.step_count(); ++i) {
      Transition t{};
      market.make_transition(i, 0.5, Action::kIdle, t);
      EXPECT_EQ(step_of_input(t.state[4]), c.from_to[i].first);
      EXPECT_EQ(t.terminal, c.from_to[i].second < 0 ? 1 : 0) << i;
      const int next = step_of_input(t.next_state[4]);
      if (c.from_to[i].second >= 0) {
        EXPECT_EQ(next, c.from_to[i].second);
        EXPECT_NEAR(t.next_state[1] - t.state[1], 1.0 / 95, 1e-4) << "quarter-hour moves along";
      }
      for (const int step : {step_of_input(t.state[4]), next}) {
        EXPECT_FALSE(step >= 8 && step < 12) << "validation day";
        EXPECT_LT(step, 20) << "test day";
      }
    }
    ASSERT_EQ(market.days().size(), c.day_counts.size());
    std::size_t first = 0;
    for (std::size_t d = 0; d < c.day_counts.size(); ++d) {
      EXPECT_EQ(market.days()[d].first, first);
      EXPECT_EQ(market.days()[d].count, c.day_counts[d]);
      first += c.day_counts[d];
    }
  }
}

TEST(TrainingDays, NoTrainingDayIsAUserError) {
  const MarketSteps market = market_by_hand({{Split::kValidation, {0, 1}}, {Split::kTest, {2, 3}}});
  EXPECT_NE(
      refusal_of([&] { TrainingMarket(market, straight_price_map(), {}, Horizon::kDay, {}); }), "");
}

TEST(TrainingDays, OnASimulatedMarketStayInsideTheTrainingDays) {
  const MarketSteps steps = simulated_market({2023, 1, 18}, 18);  // 18th to 4th: a gap within
  const PriceMap map = PriceMap::fit(observed_training_prices(steps));
  const TrainingMarket market(steps, map, {}, Horizon::kContinuing, {});
  std::size_t expected = 0;
  for (const MarketDay& day : steps.days_of(Split::kTrain)) {
    EXPECT_LE(day.day, 20);
    expected += day.step_count;
  }
  EXPECT_EQ(market.step_count(), expected - 2) << "one last step each block";
  EXPECT_EQ(observed_training_prices(steps).size(), expected);
}

// ---- Counterfactual draws -------------------------------------------------------------------

class Counterfactual : public testing::Test {
 protected:
  const TrainingMarket market{uneven_market(), straight_price_map(), {}, kOn, {}};

  std::vector<Transition> drawn(std::size_t count, const ContextJitter& jitter) const {
    Random random(72);
    std::vector<Transition> out;
    draw_counterfactual(market, count, jitter, random, out);
    return out;
  }
};

TEST_F(Counterfactual, ThreeActionsShareStepAndSoc) {
  const auto transitions = drawn(3001, {});  // the last group is truncated
  ASSERT_EQ(transitions.size(), 3001u);
  std::set<int> steps;
  double low = 1;
  double high = 0;
  for (std::size_t i = 0; i < transitions.size(); ++i) {
    const Transition& t = transitions[i];
    const Transition& leader = transitions[i - i % 3];
    EXPECT_EQ(t.action, static_cast<int>(i % 3));
    for (int k = 0; k < kNetworkInputs; ++k) EXPECT_EQ(t.state[k], leader.state[k]);
    for (const int k : {0, 1, 2, 4}) EXPECT_EQ(t.next_state[k], leader.next_state[k]);
    if (i % 3 == 2) {
      EXPECT_GE(t.next_state[3], transitions[i - 1].next_state[3]);
      EXPECT_GE(transitions[i - 1].next_state[3], leader.next_state[3]);
    }
    steps.insert(step_of_input(t.state[4]));
    low = std::min(low, double{t.state[3]});
    high = std::max(high, double{t.state[3]});
  }
  EXPECT_EQ(steps.size(), market.step_count()) << "every step is drawn";
  EXPECT_NEAR(low, 0.10, 0.01);
  EXPECT_NEAR(high, 0.99, 0.02);
}

TEST_F(Counterfactual, WithoutJitterItIsTheObservedCalendar) {
  for (const Transition& t : drawn(300, {0, 0})) {
    EXPECT_EQ(t.state[2], scaled_input(6 - 1, kContextClassScale));
    EXPECT_EQ(t.state[2], t.next_state[2]);
    EXPECT_NEAR(t.next_state[1] - t.state[1], 1.0 / 95, 1e-4);
  }
}

TEST_F(Counterfactual, JitterMovesStateAndSuccessorAlikeInsideTheRange) {
  constexpr ContextJitter kJitter{4, 2};
  const auto plain = drawn(9000, {0, 0});
  const auto moved = drawn(9000, kJitter);
  double squares[2] = {0, 0};
  std::size_t clamped = 0;
  for (std::size_t i = 0; i < plain.size(); ++i) {
    for (const int k : {0, 3, 4}) {
      ASSERT_EQ(moved[i].state[k], plain[i].state[k]);
      ASSERT_EQ(moved[i].next_state[k], plain[i].next_state[k]);
    }
    ASSERT_EQ(moved[i].reward, plain[i].reward);
    for (const int k : {1, 2}) {
      const float here = moved[i].state[k];
      const float next = moved[i].next_state[k];
      for (const float x : {here, next}) {
        ASSERT_GE(x, 0);
        ASSERT_LE(x, 1);
      }
      ASSERT_EQ(here, moved[i - i % 3].state[k]) << "the three actions share it";
      if (here == 0 || here == 1 || next == 0 || next == 1) {
        ++clamped;
        continue;
      }
      const double shift = double{here} - plain[i].state[k];
      ASSERT_NEAR(shift, double{next} - plain[i].next_state[k], 1e-6);
      squares[k - 1] += shift * shift;
    }
  }
  const auto count = static_cast<double>(plain.size());
  EXPECT_LT(static_cast<double>(clamped), 0.05 * count);
  for (const Transition& t : drawn(300, {500, 50})) {
    for (const int k : {1, 2}) ASSERT_TRUE(t.state[k] >= 0 && t.state[k] <= 1) << t.state[k];
  }
  EXPECT_NEAR(std::sqrt(squares[0] / count), kJitter.quarter_hours / 95, 0.1 * 4 / 95);
  EXPECT_NEAR(std::sqrt(squares[1] / count), kJitter.classes / 11, 0.15 * 2 / 11);
}

}  // namespace
}  // namespace bess
