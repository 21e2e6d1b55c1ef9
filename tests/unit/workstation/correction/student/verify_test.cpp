#include "workstation/correction/student/certificate.h"

#include <gtest/gtest.h>

#include "tests/support/student_nets.h"
#include "workstation/correction/student/student_file.h"

namespace bess {
namespace {

constexpr std::int64_t kContextStates = std::int64_t{kSocCount} * kPriceCount;
/// One context of the whole lattice: enough for nets that only depend on price and SoC.
constexpr int kOneContext = kContextCount;

TEST(Verify, BoundsAndEnumerationGiveTheSameGrid) {
  const struct {
    const char* name;
    StudentNet net;
    LatticeState context;
  } cases[] = {
      {"random", seeded_net(1), {0, 0, 1, 0, 0}},
      {"random, another", seeded_net(2), {7, 50, 6, 0, 0}},
      {"compiled student", compiled_student().net, {14, 95, 12, 0, 0}},
      {"adversarial", adversarial_net(1), {3, 20, 3, 0, 0}},
      {"adversarial, another", adversarial_net(2), {14, 0, 12, 0, 0}},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    ASSERT_LE(accumulator_bound(c.net), INT32_MAX);
    std::vector<std::int8_t> bounded, exhaustive;
    const std::int64_t some = fill_action_grid(c.net, c.context, false, bounded);
    const std::int64_t all = fill_action_grid(c.net, c.context, true, exhaustive);
    EXPECT_EQ(all, kContextStates);
    EXPECT_LE(some, kContextStates);
    EXPECT_TRUE(bounded == exhaustive);
  }
}

/// Cheaper than whole grids: many contexts, a sample of states of each.
TEST(Verify, BoundsAgreeWithTheNetOnManyContexts) {
  Random random(501);
  const StudentNet nets[] = {seeded_net(3), seeded_net(4), seeded_net(5), compiled_student().net};
  for (int round = 0; round < 40; ++round) {
    const StudentNet& net = nets[round % std::size(nets)];
    LatticeState state = random_state(random);
    std::vector<std::int8_t> grid;
    fill_action_grid(net, state, false, grid);
    ASSERT_EQ(grid.size(), static_cast<std::size_t>(kContextStates));
    for (int n = 0; n < 2000; ++n) {
      const LatticeState other = random_state(random);
      state.soc_index = other.soc_index;
      state.price_eur_per_mwh = other.price_eur_per_mwh;
      const int at =
          state.soc_index * kPriceCount + state.price_eur_per_mwh - kLatticePriceMinEurPerMwh;
      ASSERT_EQ(grid[at], static_cast<std::int8_t>(net.decide(state)));
    }
  }
}

TEST(Verify, BoundsSaveWork) {
  std::vector<std::int8_t> grid;
  EXPECT_LT(fill_action_grid(LinearNet{}.net(), {0, 0, 1, 0, 0}, false, grid), kContextStates / 20);
  EXPECT_LT(fill_action_grid(compiled_student().net, {5, 30, 4, 0, 0}, false, grid),
            kContextStates / 4);
}

struct Counts {
  std::int64_t low = 0, high = 0, order = 0;
  friend bool operator==(const Counts&, const Counts&) = default;
};

std::ostream& operator<<(std::ostream& out, const Counts& c) {
  return out << c.low << " / " << c.high << " / " << c.order;
}

Counts counts_of(const Certificate& c) {
  return {c.violations_of(1), c.violations_of(2), c.violations_of(3)};
}

/// By the definitions, over one context.
template <typename Decide>
Counts brute_force(Decide decide, LatticeState state, int low, int high) {
  std::vector<int> action;
  action.reserve(kContextStates);
  Counts counts;
  for (int soc = 0; soc < kSocCount; ++soc) {
    for (int price = kLatticePriceMinEurPerMwh; price <= kLatticePriceMaxEurPerMwh; ++price) {
      state.soc_index = static_cast<std::int16_t>(soc);
      state.price_eur_per_mwh = static_cast<std::int16_t>(price);
      const Action decided = decide(state);
      if (price <= low && decided != Action::kCharge) ++counts.low;
      if (price >= high && decided != Action::kDischarge) ++counts.high;
      const std::size_t at = action.size();
      action.push_back(static_cast<int>(decided));
      if (price > kLatticePriceMinEurPerMwh && action[at] > action[at - 1]) ++counts.order;
      if (soc > 0 && action[at] > action[at - kPriceCount]) ++counts.order;
    }
  }
  return counts;
}

/// A stored state must itself violate a property, or begin a pair that does.
bool is_violation(const StudentNet& net, const LatticeState& state, const VerifyOptions& options) {
  const Action action = net.decide(state);
  const std::int16_t price = state.price_eur_per_mwh;
  if (price <= options.thresholds.low_eur_per_mwh && action != Action::kCharge) return true;
  if (price >= options.thresholds.high_eur_per_mwh && action != Action::kDischarge) return true;
  LatticeState dearer = state, fuller = state;
  ++dearer.price_eur_per_mwh;
  ++fuller.soc_index;
  return (price < kLatticePriceMaxEurPerMwh && net.decide(dearer) > action) ||
         (state.soc_index < kSocCount - 1 && net.decide(fuller) > action);
}

TEST(Verify, CountsMatchTheDefinitions) {
  const LinearNet never_charges{.charge_below = 0}, never_discharges{.discharge_from = 20'000};
  const LinearNet always_idles{.charge_below = 0, .discharge_from = 20'000};
  const LinearNet falls_in_both{
      .price_weight = 2, .soc_weight = 1, .charge_below = 17'000, .discharge_from = 30'000};
  const LinearNet rises_with_price{.price_weight = -1, .offset = 16'000};
  const LinearNet rises_with_soc{.soc_weight = -1, .offset = 17'000};
  const LinearNet rises_between{.price_weight = 2, .soc_weight = -1, .offset = 3000};
  const struct {
    const char* name;
    LinearNet net;
    PriceThresholds thresholds;
    std::string_view broken;  ///< numbers of the properties
  } cases[] = {
      {"keeps all", {}, {-500, 1500}, ""},
      {"keeps all, falling in SoC too", falls_in_both, {-500, 1500}, ""},
      {"never charges", never_charges, {-500, 1500}, "1"},
      {"never discharges", never_discharges, {-500, 1500}, "2"},
      {"rises with price", rises_with_price, {-500, 1500}, "1 2 3"},
      {"rises with SoC", rises_with_soc, {-500, 1500}, "1 3"},
      {"rises with SoC between the thresholds", rises_between, {-500, 1500}, "3"},
      {"thresholds inside, kept", {}, {-1, 1000}, ""},
      {"thresholds inside, one beyond", {}, {0, 999}, "1 2"},
      {"thresholds outside", always_idles, {-501, 1501}, ""},
      {"thresholds far outside", always_idles, {-15'000, 15'000}, ""},
      {"all prices are low", {}, {1500, 1501}, "1"},
      {"all prices are high", {}, {-501, -500}, "2"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.name);
    const StudentNet net = c.net.net();
    ASSERT_LE(accumulator_bound(net), INT32_MAX);
    const VerifyOptions options{
        .thresholds = c.thresholds, .context_stride = kOneContext, .threads = 1};
    const Certificate certificate = verify_student(net, options);
    const auto answer = [&c](const LatticeState& s) { return c.net.action(s); };
    EXPECT_EQ(counts_of(certificate),
              brute_force(answer, {0, 0, 1, 0, 0}, c.thresholds.low_eur_per_mwh,
                          c.thresholds.high_eur_per_mwh));
    for (const int property : {1, 2, 3}) {
      const bool is_broken = c.broken.find(std::to_string(property)) != c.broken.npos;
      EXPECT_EQ(certificate.violations_of(property) > 0, is_broken) << property;
    }
    EXPECT_EQ(certificate.thresholds, options.thresholds);
    EXPECT_EQ(certificate.counterexamples.empty(), certificate.violations() == 0);
    for (const LatticeState& state : certificate.counterexamples) {
      ASSERT_TRUE(is_violation(net, state, options));
    }
  }
}

TEST(Verify, ThreadsDoNotChangeTheCounts) {
  const StudentNet net = seeded_net(12);
  VerifyOptions options{
      .thresholds = {-100, 500}, .context_stride = 1571, .counterexamples_max = 100, .threads = 1};
  const Certificate one = verify_student(net, options);
  ASSERT_GT(one.violations(), 0);
  EXPECT_LE(one.counterexamples.size(), 100U);
  for (const int threads : {2, 3, 40}) {
    SCOPED_TRACE(threads);
    options.threads = threads;
    const Certificate many = verify_student(net, options);
    EXPECT_EQ(counts_of(many), counts_of(one));
    EXPECT_EQ(many.states_checked, one.states_checked);
    EXPECT_EQ(many.states_evaluated, one.states_evaluated);
    for (const LatticeState& state : many.counterexamples) {
      ASSERT_TRUE(is_violation(net, state, options));
    }
  }
}

}  // namespace
}  // namespace bess
