// Student net: 5 -> 64 -> 32 -> 3, ReLU, in integers only [SPEC 5, 6].
//
//   lattice state --input map--> x int16[5] --Affine,ReLU--> int16[64] --Affine,ReLU--> int16[32]
//                 --Affine--> logits int32[3] (discharge, idle, charge) --argmax--> action
//
// The input map is part of the net: linear for time and SoC, and a monotone table for the price,
// fitted on the training days. Only differences of logits matter, so the last layer is not
// rescaled. Trivial type with inline storage: no heap, no pointers.
#pragma once

#include <cstdint>

#include "shared/action.h"
#include "shared/context_classes.h"
#include "shared/crc32.h"
#include "shared/features.h"
#include "shared/fixed_point.h"

namespace bess {

/// One affine layer: y = W^T x + b with int16 weights and activations, int32 sums. Weights are
/// stored input-major, so the inner loop runs over outputs without a horizontal sum. The exporter
/// proves that no accumulator can overflow (student/student_file.h), so there is no check.
template <int kInputs, int kOutputs>
struct Affine {
  std::int16_t weight[kInputs][kOutputs];
  std::int32_t bias[kOutputs];

  constexpr void propagate(const std::int16_t (&x)[kInputs], std::int32_t (&y)[kOutputs]) const {
    for (int o = 0; o < kOutputs; ++o) y[o] = bias[o];
    for (int i = 0; i < kInputs; ++i) {
      for (int o = 0; o < kOutputs; ++o) y[o] += std::int32_t{weight[i][o]} * x[i];
    }
  }
};

/// ReLU with rescaling from the int32 accumulator to the next layer's int16 activation:
/// y = clamp(round(x / 2^shift), 0, 32767). Monotone, which the proof's interval bounds rely on.
template <int kCount>
struct ClippedRelu {
  std::int32_t shift;  ///< 0..30; each net uses the full range of int16

  constexpr std::int16_t rescale(std::int32_t x) const {
    return static_cast<std::int16_t>(
        clamp_to<std::int32_t>(rounding_shift_right(x, shift), 0, INT16_MAX));
  }
  constexpr void propagate(const std::int32_t (&x)[kCount], std::int16_t (&y)[kCount]) const {
    for (int i = 0; i < kCount; ++i) y[i] = rescale(x[i]);
  }
};

inline constexpr int kStudentInputs = 5;
inline constexpr int kStudentHidden1 = 64;
inline constexpr int kStudentHidden2 = 32;

// Inputs are Q14: 0 .. 16384 spans the whole range of each quantity.
inline constexpr int kInputOne = 1 << 14;
inline constexpr int kMinuteOfQuarterHourScale = kInputOne / (kMinuteOfQuarterHourCount - 1);
inline constexpr int kQuarterHourScale = kInputOne / (kQuarterHourCount - 1);
inline constexpr int kContextClassScale = kInputOne / (kContextClassCount - 1);
inline constexpr int kSocScale = kInputOne / (kSocCount - 1);
static_assert(kSocScale * (kSocCount - 1) <= INT16_MAX && kSocScale > 0);

struct StudentNet {
  ContextClasses context;  ///< meaning of the third input
  std::int16_t
      price_map[kPriceCount];  ///< Q14, strictly increasing, from lattice price -500 upwards
  Affine<kStudentInputs, kStudentHidden1> layer1;
  ClippedRelu<kStudentHidden1> relu1;
  Affine<kStudentHidden1, kStudentHidden2> layer2;
  ClippedRelu<kStudentHidden2> relu2;
  Affine<kStudentHidden2, kActionCount> layer3;

  /// Network input of a lattice state, order T_qh, qh, context class, SoC, price.
  constexpr void quantise(const LatticeState& s, std::int16_t (&x)[kStudentInputs]) const {
    x[0] = static_cast<std::int16_t>(s.minute_of_quarter_hour * kMinuteOfQuarterHourScale);
    x[1] = static_cast<std::int16_t>(s.quarter_hour * kQuarterHourScale);
    x[2] = static_cast<std::int16_t>((s.context_class - 1) * kContextClassScale);
    x[3] = static_cast<std::int16_t>(s.soc_index * kSocScale);
    x[4] = price_map[s.price_eur_per_mwh - kLatticePriceMinEurPerMwh];
  }

  /// Logits of discharge, idle, charge for a quantised input.
  constexpr void propagate(const std::int16_t (&x)[kStudentInputs],
                           std::int32_t (&logits)[kActionCount]) const {
    std::int32_t sum1[kStudentHidden1];
    std::int16_t hidden1[kStudentHidden1];
    std::int32_t sum2[kStudentHidden2];
    std::int16_t hidden2[kStudentHidden2];
    layer1.propagate(x, sum1);
    relu1.propagate(sum1, hidden1);
    layer2.propagate(hidden1, sum2);
    relu2.propagate(sum2, hidden2);
    layer3.propagate(hidden2, logits);
  }

  [[nodiscard]] constexpr Action decide(const LatticeState& s) const {
    std::int16_t x[kStudentInputs] = {};
    std::int32_t logits[kActionCount] = {};
    quantise(s, x);
    propagate(x, logits);
    return argmax_action(logits);
  }
};

namespace detail {
template <int kInputs, int kOutputs>
constexpr void add_layer(Crc32& crc, const Affine<kInputs, kOutputs>& layer) {
  for (const auto& row : layer.weight) {
    for (const std::int16_t w : row) crc.add_integer(w);
  }
  for (const std::int32_t b : layer.bias) crc.add_integer(b);
}
}  // namespace detail

/// Hash of the architecture: weights exported for another shape or input map do not compile.
constexpr std::uint32_t student_architecture_hash() {
  Crc32 crc;
  for (const int fact :
       {kStudentInputs, kStudentHidden1, kStudentHidden2, kActionCount, kMinuteOfQuarterHourScale,
        kQuarterHourScale, kContextClassScale, kSocScale, kPriceCount, kLatticePriceMinEurPerMwh}) {
    crc.add_integer(fact);
  }
  return crc.value();
}

/// Hash of every number of the net, in declaration order, independent of the machine's byte order.
/// The context month adds nothing, which keeps the hashes of existing nets unchanged.
constexpr std::uint32_t student_weights_hash(const StudentNet& net) {
  Crc32 crc;
  if (net.context.is_outlook()) crc.add_integer(static_cast<int>(net.context.kind));
  if (net.context.kind != ContextKind::kMonth) {
    for (const std::int16_t edge : net.context.level_edge_eur_per_mwh) crc.add_integer(edge);
  }
  for (const std::int16_t p : net.price_map) crc.add_integer(p);
  detail::add_layer(crc, net.layer1);
  crc.add_integer(net.relu1.shift);
  detail::add_layer(crc, net.layer2);
  crc.add_integer(net.relu2.shift);
  detail::add_layer(crc, net.layer3);
  return crc.value();
}

/// Quartile (1 to 3) of the training prices, whole EUR/MWh, from the price map: half their
/// distribution, half a straight line over the lattice (workstation/policy/rl/network_input.h).
constexpr std::int32_t learnt_price_quartile(const StudentNet& net, int quartile) {
  constexpr std::int32_t kSteps = kPriceCount - 1;
  for (std::int32_t step = 0; step < kSteps; ++step) {
    // In units of 1 / (kInputOne * kSteps).
    const std::int32_t share = 2 * kSteps * net.price_map[step] - kInputOne * step;
    if (4 * share >= quartile * kInputOne * kSteps) return kLatticePriceMinEurPerMwh + step;
  }
  return kLatticePriceMaxEurPerMwh;
}

}  // namespace bess
