// Integer students for tests: drawn from a seed with their kinks inside the lattice, or hand-made
// so that the action is a known function of price and SoC.
#pragma once

#include "shared/nn/student_net.h"
#include "workstation/base/random.h"

namespace bess {

inline LatticeState random_lattice_state(Random& random) {
  const auto draw = [&random](int low, int count) {
    return static_cast<std::int16_t>(low + static_cast<int>(random.index(count)));
  };
  return {.minute_of_quarter_hour = draw(0, kMinuteOfQuarterHourCount),
          .quarter_hour = draw(0, kQuarterHourCount),
          .context_class = draw(1, kContextClassCount),
          .soc_index = draw(0, kSocCount),
          .price_eur_per_mwh = draw(kLatticePriceMinEurPerMwh, kPriceCount)};
}

/// price_map[i] = 8 i: strictly increasing, 0 .. 16000.
inline void set_even_price_map(StudentNet& net) {
  for (int i = 0; i < kPriceCount; ++i) net.price_map[i] = static_cast<std::int16_t>(8 * i);
}

/// Weights uniform and small enough that no accumulator can overflow; the biases put each unit's
/// kink, and equal logits, at random lattice states.
inline StudentNet random_integer_net(std::uint64_t seed) {
  Random random(seed);
  const auto weight = [&random](int bound) {
    return static_cast<std::int16_t>(static_cast<int>(random.index(2 * bound + 1)) - bound);
  };
  StudentNet net{};
  set_even_price_map(net);
  net.relu1.shift = 14;
  net.relu2.shift = 16;
  for (auto& row : net.layer1.weight) {
    for (std::int16_t& w : row) w = weight(4000);
  }
  for (auto& row : net.layer2.weight) {
    for (std::int16_t& w : row) w = weight(1000);
  }
  for (auto& row : net.layer3.weight) {
    for (std::int16_t& w : row) w = weight(2000);
  }
  std::int16_t x[kStudentInputs];
  for (int o = 0; o < kStudentHidden1; ++o) {
    net.quantise(random_lattice_state(random), x);
    for (int i = 0; i < kStudentInputs; ++i) net.layer1.bias[o] -= net.layer1.weight[i][o] * x[i];
  }
  std::int32_t logits[kActionCount];
  net.quantise(random_lattice_state(random), x);
  net.propagate(x, logits);
  for (int a = 0; a < kActionCount; ++a) net.layer3.bias[a] = -logits[a];
  return net;
}

/// Input of a hand-made net.
enum class NetInput { kSoc = 3, kPrice = 4 };

/// Logits: discharge = slope * (low - x), idle = 0, charge = slope * (x - high) with x the
/// quantised input, low < high. slope > 0 charges at large x, slope < 0 exchanges the two actions.
inline StudentNet hand_made_net(NetInput input, int slope, int low, int high) {
  StudentNet net{};
  set_even_price_map(net);
  const int i = static_cast<int>(input);
  net.layer1.weight[i][0] = 1;
  net.layer2.weight[0][0] = 1;
  const int discharge = static_cast<int>(Action::kDischarge);
  const int charge = static_cast<int>(Action::kCharge);
  const int rising = slope > 0 ? charge : discharge;
  const int falling = slope > 0 ? discharge : charge;
  const int steepness = slope > 0 ? slope : -slope;
  net.layer3.weight[0][rising] = static_cast<std::int16_t>(steepness);
  net.layer3.bias[rising] = -steepness * high;
  net.layer3.weight[0][falling] = static_cast<std::int16_t>(-steepness);
  net.layer3.bias[falling] = steepness * low;
  return net;
}

/// The same action everywhere.
inline StudentNet constant_net(Action action) {
  StudentNet net{};
  set_even_price_map(net);
  net.layer3.bias[static_cast<int>(action)] = 1;
  return net;
}

}  // namespace bess
