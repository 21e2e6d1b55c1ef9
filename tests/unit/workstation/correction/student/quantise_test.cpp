#include "workstation/correction/student/student_file.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/host/user_error.h"
#include "tests/support/student_nets.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {
namespace {

/// Largest magnitude of any sum of one evaluation, partial sums and rounding included.
struct Observed {
  std::int64_t sum = 0;
  std::int64_t activation = 0;

  template <int kInputs, int kOutputs>
  void layer(const Affine<kInputs, kOutputs>& affine, const std::int16_t (&x)[kInputs], int shift) {
    for (int o = 0; o < kOutputs; ++o) {
      std::int64_t total = affine.bias[o];
      sum = std::max(sum, std::abs(total));
      for (int i = 0; i < kInputs; ++i) {
        total += std::int64_t{affine.weight[i][o]} * x[i];
        sum = std::max(sum, std::abs(total));
      }
      if (shift > 0) sum = std::max(sum, std::abs(total + (std::int64_t{1} << (shift - 1))));
    }
  }
};

Observed observe(const StudentNet& net, const LatticeState& state) {
  std::int16_t x[kStudentInputs];
  std::int32_t sum1[kStudentHidden1], sum2[kStudentHidden2];
  std::int16_t h1[kStudentHidden1], h2[kStudentHidden2];
  Observed observed;
  net.quantise(state, x);
  observed.layer(net.layer1, x, net.relu1.shift);
  net.layer1.propagate(x, sum1);
  net.relu1.propagate(sum1, h1);
  observed.layer(net.layer2, h1, net.relu2.shift);
  net.layer2.propagate(h1, sum2);
  net.relu2.propagate(sum2, h2);
  observed.layer(net.layer3, h2, 0);
  observed.activation = std::max(*std::ranges::max_element(h1), *std::ranges::max_element(h2));
  return observed;
}

Parameters scaled_parameters(std::uint64_t seed, float first, float second, float third) {
  Parameters parameters = initial_parameters(kStudentShape, seed);
  MutableMlp mlp(kStudentShape, parameters.data());
  mlp.w1 *= first;
  mlp.b1 *= first;
  mlp.w2 *= second;
  mlp.b2 *= second;
  mlp.w3 *= third;
  mlp.b3 *= third;
  return parameters;
}

struct ScaleCase {
  const char* name;
  float first, second, third;
};

const ScaleCase kScales[] = {
    {"as drawn", 1, 1, 1},       {"trained size", 4, 6, 8},  {"small", 1e-3F, 1e-3F, 1e-3F},
    {"large first", 300, 1, 1},  {"large second", 1, 90, 1}, {"large third", 1, 1, 900},
    {"tiny first", 1e-6F, 1, 1}, {"all zero", 0, 0, 0},
};

TEST(Quantise, SumsStayInsideTheBound) {
  const PriceMap map(even_price_table());
  for (const ScaleCase& c : kScales) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(c.name);
      const StudentNet net =
          quantise_student(scaled_parameters(seed, c.first, c.second, c.third), map);
      for (const int shift : {net.relu1.shift, net.relu2.shift}) {
        EXPECT_GE(shift, 0);
        EXPECT_LE(shift, 30);
      }
      const std::int64_t bound = accumulator_bound(net);
      EXPECT_LE(bound, std::numeric_limits<std::int32_t>::max());
      Random random(seed);
      for (int n = 0; n < 2000; ++n) {
        const Observed observed = observe(net, random_state(random));
        ASSERT_LE(observed.sum, bound);
        ASSERT_LT(observed.activation, std::numeric_limits<std::int16_t>::max()) << "saturated";
      }
    }
  }
}

TEST(Quantise, BoundHoldsForAdversarialNets) {
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const StudentNet net = adversarial_net(seed);
    const std::int64_t bound = accumulator_bound(net);
    Random random(seed);
    for (int n = 0; n < 2000; ++n) ASSERT_LE(observe(net, random_state(random)).sum, bound);
  }
}

TEST(Quantise, BoundIsTightForOneInput) {
  StudentNet net = LinearNet{.price_weight = 3}.net();
  net.price_map[kPriceCount - 1] = kInputOne;
  net.relu1.shift = 2;
  // 3 * 16384 + 2 for rounding; the later layers are smaller.
  EXPECT_EQ(accumulator_bound(net), 3 * kInputOne + 2);
}

TEST(Quantise, IntegersAgreeWithFloat) {
  constexpr int kStates = 20'000;
  const PriceMap map(even_price_table());
  for (const ScaleCase& c : {kScales[0], kScales[1]}) {
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      SCOPED_TRACE(c.name);
      const Parameters parameters = scaled_parameters(seed, c.first, c.second, c.third);
      const StudentNet net = quantise_student(parameters, map);
      const ConstMlp mlp(kStudentShape, parameters.data());
      Random random(seed + 50);
      Matrix x(kNetworkInputs, kStates);
      std::vector<LatticeState> states;
      for (int n = 0; n < kStates; ++n) {
        states.push_back(random_state(random));
        const LatticeState& s = states.back();
        write_input(network_context(s.minute_of_quarter_hour, s.quarter_hour, s.context_class,
                                    map(s.price_eur_per_mwh)),
                    s.soc_index / double{kSocCount - 1}, x.col(n).data());
      }
      MlpTile tile;
      Matrix z;
      forward_hidden(mlp, x, tile);
      forward_head(mlp, tile, z);
      int agreed = 0;
      for (int n = 0; n < kStates; ++n) {
        agreed += net.decide(states[n]) == argmax_action(z.col(n).data()) ? 1 : 0;
      }
      EXPECT_GT(agreed, kStates * 0.995);
    }
  }
}

TEST(Quantise, AbsurdWeightsAreRefused) {
  const PriceMap map(even_price_table());
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float infinite = std::numeric_limits<float>::infinity();
  for (const ScaleCase& c : {ScaleCase{"first", 1e6F, 1, 1}, ScaleCase{"second", 1, 1e9F, 1},
                             ScaleCase{"third", 1, 1, 1e9F}, ScaleCase{"infinite", infinite, 1, 1},
                             ScaleCase{"not a number", 1, nan, 1}}) {
    SCOPED_TRACE(c.name);
    EXPECT_THROW(quantise_student(scaled_parameters(1, c.first, c.second, c.third), map),
                 UserError);
  }
}

/// The sums fit, the activations do not: int16 would clip values that float does not.
TEST(Quantise, SaturatingActivationsAreRefused) {
  const PriceMap map(even_price_table());
  for (const int layer : {1, 2}) {
    SCOPED_TRACE(layer);
    Parameters parameters = Parameters::Zero(kStudentShape.parameter_count());
    MutableMlp mlp(kStudentShape, parameters.data());
    if (layer == 1) {
      mlp.w1.row(0).setConstant(8000);  // up to 40,000
    } else {
      mlp.w1(0, 0) = 1;
      mlp.w2(0, 0) = 20'000;
      mlp.b2[0] = 20'000;
    }
    EXPECT_THROW(quantise_student(parameters, map), UserError);
  }
}

}  // namespace
}  // namespace bess
