#include "workstation/policy/rl/train.h"

#include <algorithm>
#include <array>
#include <map>
#include <tuple>

#include "tests/support/teachers.h"
#include "tests/unit/workstation/policy/rl/market_by_hand.h"

namespace bess {
namespace {

auto key_of(const Transition& t) {
  return std::tuple(t.state[4], t.state[3], t.action, t.reward, t.next_state[4], t.next_state[3]);
}

class ReplayOf : public testing::TestWithParam<Horizon> {
 protected:
  const TrainingMarket market{uneven_market(), straight_price_map(), {}, GetParam(), {}};
  const Teacher teacher = network_teacher(Method::kDqn, {-15, 15, 11}, straight_price_map(), 81);
};

TEST_P(ReplayOf, PlayStoresEachStepOfADayInOrder) {
  Random random(83);
  for (int day = 0; day < 40; ++day) {
    Replay replay(market, 1000);
    replay.play(teacher, 1, 0.5, random);
    const auto& played = replay.transitions();
    const int first = step_of_input(played[0].state[4]);
    const auto found = std::ranges::find_if(market.days(), [&](const TrainingMarket::Day& d) {
      Transition t{};
      market.make_transition(d.first, 0.5, Action::kIdle, t);
      return step_of_input(t.state[4]) == first;
    });
    ASSERT_NE(found, market.days().end());
    ASSERT_EQ(played.size(), found->count);
    for (std::size_t i = 0; i < played.size(); ++i) {
      EXPECT_EQ(played[i].state[4], market.context(found->first + i).price);
      if (i > 0) {
        EXPECT_EQ(played[i].state[3], played[i - 1].next_state[3]) << "the SoC continues";
      }
    }
    EXPECT_GE(played[0].state[3], 0.0999F);
  }
}

TEST_P(ReplayOf, ManyDaysAtOnceStoreTheirSteps) {
  constexpr std::size_t kDays = 16;
  Random random(84);
  Random twin(84);
  std::map<int, std::size_t> expected;  // first step of a day -> times drawn
  std::size_t steps = 0;
  for (std::size_t d = 0; d < kDays; ++d) {
    const TrainingMarket::Day day = market.days()[twin.index(market.days().size())];
    (void)market.draw_soc(twin);
    ++expected[step_of_input(market.context(day.first).price)];
    steps += day.count;
  }
  Replay replay(market, 1000);
  replay.play(teacher, kDays, 1, random);
  ASSERT_EQ(replay.transitions().size(), steps);
  std::map<int, std::size_t> stored;
  for (const Transition& t : replay.transitions()) ++stored[step_of_input(t.state[4])];
  for (const auto& [first, times] : expected) EXPECT_EQ(stored[first], times) << first;
}

TEST_P(ReplayOf, WithoutExploringItIsGreedy) {
  Random random(85);
  Replay replay(market, 1000);
  replay.play(teacher, 8, 0, random);
  MlpTile tile;
  for (const Transition& t : replay.transitions()) {
    const Matrix x = Eigen::Map<const Matrix>(t.state, kNetworkInputs, 1);
    const Matrix values = teacher.action_values(x, tile);
    EXPECT_NEAR(values(t.action, 0), values.maxCoeff(), 1e-5F);
  }
}

TEST_P(ReplayOf, ExploringTakesEveryActionAlike) {
  Random random(86);
  Replay replay(market, 100'000);
  replay.play(teacher, 1000, 1, random);
  double count[kActionCount] = {};
  const auto& played = replay.transitions();
  for (const Transition& t : played) ++count[t.action];
  for (const double times : count) {
    EXPECT_NEAR(times / static_cast<double>(played.size()), 1.0 / 3, 0.03);
  }
}

TEST_P(ReplayOf, RingOverwritesTheOldest) {
  for (const std::size_t capacity : {1u, 5u, 6u, 11u}) {
    Random random(87);
    Random twin(87);
    Replay ring(market, capacity);
    Replay all(market, 100'000);
    for (int day = 0; day < 9; ++day) {
      ring.play(teacher, 1, 0.5, random);
      all.play(teacher, 1, 0.5, twin);
      const auto& history = all.transitions();
      const std::size_t kept = std::min(capacity, history.size());
      ASSERT_EQ(ring.transitions().size(), kept);
      std::vector<decltype(key_of(Transition{}))> newest, held;
      for (std::size_t i = history.size() - kept; i < history.size(); ++i) {
        newest.push_back(key_of(history[i]));
      }
      for (const Transition& t : ring.transitions()) held.push_back(key_of(t));
      std::ranges::sort(newest);
      std::ranges::sort(held);
      ASSERT_EQ(held, newest) << "capacity " << capacity << ", day " << day;
    }
  }
}

TEST_P(ReplayOf, DrawsReachEverySlotAlike) {
  Random random(88);
  Replay replay(market, 1000);
  replay.play(teacher, 4, 0.5, random);
  const std::size_t size = replay.transitions().size();
  MiniBatch batch;
  replay.draw(1000 * size, random, batch);
  std::map<std::array<float, 3>, int> drawn, held;
  for (const Transition& t : replay.transitions()) ++held[{t.state[3], t.state[4], t.reward}];
  for (Eigen::Index i = 0; i < batch.size(); ++i) {
    ++drawn[{batch.state(3, i), batch.state(4, i), batch.reward[i]}];
  }
  ASSERT_EQ(drawn.size(), held.size());
  for (const auto& [key, times] : held) EXPECT_NEAR(drawn[key], 1000 * times, 150 * times);
}

INSTANTIATE_TEST_SUITE_P(Horizons, ReplayOf, testing::Values(Horizon::kContinuing, Horizon::kDay),
                         [](const auto& instance) {
                           return instance.param == Horizon::kDay ? "day" : "continuing";
                         });

}  // namespace
}  // namespace bess
