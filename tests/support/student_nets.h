// Nets for the tests: seeded, hand-made with known answers, and adversarial.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "tests/support/integer_nets.h"
#include "workstation/correction/distillation/distil.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/policy/rl/network_input.h"

namespace bess {

/// 8 * price index: strictly increasing, 0 .. 16000.
inline std::array<std::int16_t, kPriceCount> even_price_table() {
  std::array<std::int16_t, kPriceCount> table{};
  for (int p = 0; p < kPriceCount; ++p) table[p] = static_cast<std::int16_t>(8 * p);
  return table;
}

inline StudentNet seeded_net(std::uint64_t seed) {
  return quantise_student(initial_parameters(kStudentShape, seed), PriceMap(even_price_table()));
}

inline LatticeState random_state(Random& random) { return random_lattice_state(random); }

/// Depends on price and SoC alone:  h = relu(price_weight * price + soc_weight * SoC + offset) in
/// input units, discharge when h >= discharge_from, charge when h < charge_below, idle between.
struct LinearNet {
  int price_weight = 1;
  int soc_weight = 0;
  int offset = 0;
  int charge_below = 4000;
  int discharge_from = 12'000;

  /// The expected answer, without the net.
  [[nodiscard]] Action action(const LatticeState& s) const {
    const int price = 8 * (s.price_eur_per_mwh - kLatticePriceMinEurPerMwh);
    const int soc = 81 * s.soc_index;
    const int h = std::clamp(price_weight * price + soc_weight * soc + offset, 0, 32'767);
    const int value[kActionCount] = {h - discharge_from, 0, charge_below - h};
    return argmax_action(value);
  }
  [[nodiscard]] StudentNet net() const {
    StudentNet n{};
    set_even_price_map(n);
    n.layer1.weight[3][0] = static_cast<std::int16_t>(soc_weight);
    n.layer1.weight[4][0] = static_cast<std::int16_t>(price_weight);
    n.layer1.bias[0] = offset;
    n.layer2.weight[0][0] = 1;
    n.layer3.weight[0][static_cast<int>(Action::kDischarge)] = 1;
    n.layer3.bias[static_cast<int>(Action::kDischarge)] = -discharge_from;
    n.layer3.weight[0][static_cast<int>(Action::kCharge)] = -1;
    n.layer3.bias[static_cast<int>(Action::kCharge)] = charge_below;
    return n;
  }
};

/// Large weights of alternating sign in every layer: interval bounds gain almost nothing.
inline StudentNet adversarial_net(std::uint64_t seed) {
  Random random(seed);
  StudentNet n{};
  set_even_price_map(n);
  const auto alternating = [&random](auto& layer, int magnitude) {
    int sign = 1;
    for (auto& row : layer.weight) {
      for (std::int16_t& w : row) {
        w = static_cast<std::int16_t>(
            sign * (magnitude / 2 +
                    static_cast<int>(random.index(static_cast<std::size_t>(magnitude / 2)))));
        sign = random.uniform() < 0.9 ? -sign : sign;
      }
    }
  };
  alternating(n.layer1, 20'000);
  n.relu1.shift = 14;
  alternating(n.layer2, 900);
  n.relu2.shift = 10;
  alternating(n.layer3, 1'900);
  for (std::int32_t& b : n.layer1.bias) {
    b = static_cast<std::int32_t>((random.uniform() - 0.5) * 2e8);
  }
  return n;
}

}  // namespace bess
