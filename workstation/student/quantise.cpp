#include "workstation/student/quantise.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "shared/host/user_error.h"
#include "workstation/correction/distil.h"

namespace bess {
namespace {

constexpr int kInputBits = 14;  // inputs are Q14
static_assert(kInputOne == 1 << kInputBits);
/// Accumulators keep one bit of headroom, for the rounding constant and the bias.
constexpr double kAccumulatorMax = 1 << 30;

/// Bounds of a layer's activations over all inputs, by interval arithmetic in float.
struct Range {
  Eigen::VectorXd low, high;
};

Range affine_range(const Eigen::MatrixXd& w, const Eigen::VectorXd& b, const Range& x) {
  const Eigen::MatrixXd positive = w.cwiseMax(0.0);
  const Eigen::MatrixXd negative = w.cwiseMin(0.0);
  return {positive * x.low + negative * x.high + b, positive * x.high + negative * x.low + b};
}

Range relu_range(const Range& x, double saturation) {
  return {x.low.cwiseMax(0.0).cwiseMin(saturation), x.high.cwiseMax(0.0).cwiseMin(saturation)};
}

/// Largest f with max|w| * 2^f inside int16 and every accumulator at scale 2^(f + input_bits)
/// inside.
int weight_bits(const Eigen::MatrixXd& w, const Eigen::VectorXd& b, const Range& x,
                int input_bits) {
  const double accumulator =
      (w.cwiseAbs() * x.high.cwiseAbs().cwiseMax(x.low.cwiseAbs()) + b.cwiseAbs()).maxCoeff();
  for (int f = 15; f >= 0; --f) {
    const double scale = std::ldexp(1.0, f);
    const bool weights_fit = w.cwiseAbs().maxCoeff() * scale < INT16_MAX - 1;
    if (weights_fit && accumulator * std::ldexp(scale, input_bits) < kAccumulatorMax) return f;
  }
  fail("the student's weights are too large for int16; distil again with a smaller learning rate");
}

/// Largest scale at which the activation's upper bound stays inside int16; where activations
/// saturate, the one at which int16 ends there too.
int activation_bits(const Range& x, double saturation) {
  constexpr int kInt16Bits = 15;
  if (std::isfinite(saturation)) return kInt16Bits - static_cast<int>(std::log2(saturation));
  const double highest = std::max(x.high.maxCoeff(), 1e-6);
  if (highest > INT16_MAX) {
    fail(
        "the student's activations are too large for int16; distil again with a smaller learning "
        "rate");
  }
  return std::clamp(static_cast<int>(std::floor(std::log2(INT16_MAX / highest))), 0, 20);
}

template <int kInputs, int kOutputs>
void quantise_layer(const Eigen::MatrixXd& w, const Eigen::VectorXd& b, int bits, int input_bits,
                    Affine<kInputs, kOutputs>& layer) {
  for (int i = 0; i < kInputs; ++i) {
    for (int o = 0; o < kOutputs; ++o) {
      layer.weight[i][o] = static_cast<std::int16_t>(std::lround(std::ldexp(w(o, i), bits)));
    }
  }
  for (int o = 0; o < kOutputs; ++o) {
    layer.bias[o] = static_cast<std::int32_t>(std::lround(std::ldexp(b[o], bits + input_bits)));
  }
}

/// Largest magnitude of the layer's sums, given the largest value of each (non-negative) input.
template <int kInputs, int kOutputs>
std::int64_t sum_bound(const Affine<kInputs, kOutputs>& layer,
                       const std::vector<std::int64_t>& input_max) {
  std::int64_t bound = 0;
  for (int o = 0; o < kOutputs; ++o) {
    std::int64_t sum = std::abs(std::int64_t{layer.bias[o]});
    for (int i = 0; i < kInputs; ++i) sum += std::abs(layer.weight[i][o] * input_max[i]);
    bound = std::max(bound, sum);
  }
  return bound;
}

/// Largest value of each activation after the layer, exact in integers.
template <int kInputs, int kOutputs>
std::vector<std::int64_t> activation_bound(const Affine<kInputs, kOutputs>& layer, int shift,
                                           const std::vector<std::int64_t>& input_max) {
  std::vector<std::int64_t> bound(kOutputs);
  for (int o = 0; o < kOutputs; ++o) {
    std::int64_t sum = layer.bias[o];
    for (int i = 0; i < kInputs; ++i) {
      sum += std::max<std::int64_t>(0, layer.weight[i][o]) * input_max[i];
    }
    bound[o] = std::clamp<std::int64_t>((sum >> shift) + 1, 0, INT16_MAX);
  }
  return bound;
}

}  // namespace

StudentNet quantise_student(const Parameters& student, const PriceMap& price_map,
                            double saturation) {
  const ConstMlp mlp(kStudentShape, student.data());
  const Eigen::MatrixXd w1 = mlp.w1.cast<double>();
  const Eigen::MatrixXd w2 = mlp.w2.cast<double>();
  const Eigen::MatrixXd w3 = mlp.w3.cast<double>();
  const Eigen::VectorXd b1 = mlp.b1.cast<double>();
  const Eigen::VectorXd b2 = mlp.b2.cast<double>();
  const Eigen::VectorXd b3 = mlp.b3.cast<double>();
  const Range input{Eigen::VectorXd::Zero(kStudentInputs), Eigen::VectorXd::Ones(kStudentInputs)};
  const Range hidden1 = relu_range(affine_range(w1, b1, input), saturation);
  const Range hidden2 = relu_range(affine_range(w2, b2, hidden1), saturation);

  StudentNet net{};
  std::ranges::copy(price_map.table(), net.price_map);
  const int bits1 = weight_bits(w1, b1, input, kInputBits);
  const int hidden1_bits = std::min(activation_bits(hidden1, saturation), bits1 + kInputBits);
  quantise_layer(w1, b1, bits1, kInputBits, net.layer1);
  net.relu1.shift = bits1 + kInputBits - hidden1_bits;
  const int bits2 = weight_bits(w2, b2, hidden1, hidden1_bits);
  const int hidden2_bits = std::min(activation_bits(hidden2, saturation), bits2 + hidden1_bits);
  quantise_layer(w2, b2, bits2, hidden1_bits, net.layer2);
  net.relu2.shift = bits2 + hidden1_bits - hidden2_bits;
  const int bits3 = weight_bits(w3, b3, hidden2, hidden2_bits);
  quantise_layer(w3, b3, bits3, hidden2_bits, net.layer3);
  return net;
}

std::int64_t accumulator_bound(const StudentNet& net) {
  const std::vector<std::int64_t> input(kStudentInputs, kInputOne);
  const auto hidden1 = activation_bound(net.layer1, net.relu1.shift, input);
  const auto hidden2 = activation_bound(net.layer2, net.relu2.shift, hidden1);
  const auto rounding = [](int shift) { return shift > 0 ? std::int64_t{1} << (shift - 1) : 0; };
  return std::max({sum_bound(net.layer1, input) + rounding(net.relu1.shift),
                   sum_bound(net.layer2, hidden1) + rounding(net.relu2.shift),
                   sum_bound(net.layer3, hidden2)});
}

}  // namespace bess
