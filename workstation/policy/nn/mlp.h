// Multilayer perceptron in float with two hidden ReLU layers and a linear head, forward and
// backward: the teacher (5-256-128-out) and the float student (5-64-32-3). Plain Eigen; samples are
// columns, so every matrix is [features x samples]. All parameters are in one flat vector, so save,
// load, Adam and averaging are single loops. Layout: W1 [h1 x in], b1, W2 [h2 x h1], b2, W3 [out x
// h2], b3, each column-major.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <cstdint>

#include "workstation/base/binary_file.h"

namespace bess {

using Matrix = Eigen::MatrixXf;
using MatrixRef = Eigen::Ref<const Matrix>;
using Parameters = Eigen::VectorXf;

struct MlpShape {
  int inputs;
  int hidden1;
  int hidden2;
  int outputs;
  [[nodiscard]] Eigen::Index parameter_count() const {
    return static_cast<Eigen::Index>(hidden1) * (inputs + 1) +
           static_cast<Eigen::Index>(hidden2) * (hidden1 + 1) +
           static_cast<Eigen::Index>(outputs) * (hidden2 + 1);
  }
  friend bool operator==(const MlpShape&, const MlpShape&) = default;
};

/// The layers as views of a flat vector; Scalar is float or const float.
template <typename Scalar>
struct MlpView {
  template <typename T>
  using Mapped = Eigen::Map<std::conditional_t<std::is_const_v<Scalar>, const T, T>>;
  Mapped<Matrix> w1;
  Mapped<Parameters> b1;
  Mapped<Matrix> w2;
  Mapped<Parameters> b2;
  Mapped<Matrix> w3;
  Mapped<Parameters> b3;

  MlpView(const MlpShape& s, Scalar* p)
      : w1(p, s.hidden1, s.inputs),
        b1(w1.data() + w1.size(), s.hidden1),
        w2(b1.data() + b1.size(), s.hidden2, s.hidden1),
        b2(w2.data() + w2.size(), s.hidden2),
        w3(b2.data() + b2.size(), s.outputs, s.hidden2),
        b3(w3.data() + w3.size(), s.outputs) {}
};
using ConstMlp = MlpView<const float>;
using MutableMlp = MlpView<float>;

/// Activations of one tile of samples, and their gradients.
struct MlpTile {
  Matrix h1, h2;    ///< [hidden x samples] after ReLU
  Matrix dh1, dh2;  ///< gradients before ReLU
};

/// Uniform in +-1/sqrt(fan in) as in PyTorch, except for the first layer: weights uniform in +-1,
/// kinks spread over the inputs' unit cube. Drawn from `seed`.
Parameters initial_parameters(const MlpShape& shape, std::uint64_t seed);

/// Parameters to and from a file; the reader must know the size.
inline void put_parameters(BinaryWriter& out, const Parameters& parameters) {
  out.put_bytes(parameters.data(), sizeof(float) * static_cast<std::size_t>(parameters.size()));
}
inline void take_parameters(BinaryReader& in, Parameters& parameters) {
  in.take_bytes(parameters.data(), sizeof(float) * static_cast<std::size_t>(parameters.size()));
}

/// h1 = relu(W1 x + b1), h2 = relu(W2 h1 + b2). x is [inputs x samples].
void forward_hidden(const ConstMlp& mlp, const MatrixRef& x, MlpTile& tile);
/// z = W3 h2 + b3, all outputs. z is [outputs x samples].
void forward_head(const ConstMlp& mlp, const MlpTile& tile, Matrix& z);

/// Adds dL/dW3, dL/db3 for all outputs and sets tile.dh2 from dz = dL/dz.
void backward_head(const ConstMlp& mlp, const MatrixRef& dz, MlpTile& tile, MutableMlp& gradient);
/// Adds the gradients of the two hidden layers; needs tile.dh2 from the head.
void backward_hidden(const ConstMlp& mlp, const MatrixRef& x, MlpTile& tile, MutableMlp& gradient);

// Adam [Kingma, Ba 2015, Algorithm 1] over one flat parameter vector.

struct Adam {
  float beta1 = 0.9F;
  float beta2 = 0.999F;
  float epsilon = 1e-8F;
  Parameters m;  ///< first moment
  Parameters v;  ///< second moment
  long step = 0;

  explicit Adam(Eigen::Index count) : m(Parameters::Zero(count)), v(Parameters::Zero(count)) {}

  void update(Parameters& parameters, const Parameters& gradient, float learning_rate) {
    ++step;
    const auto t = static_cast<double>(step);
    const auto rate = static_cast<float>(learning_rate / (1 - std::pow(double{beta1}, t)));
    const auto v_scale = static_cast<float>(1 / (1 - std::pow(double{beta2}, t)));
    m.array() += (1 - beta1) * (gradient.array() - m.array());
    v.array() += (1 - beta2) * (gradient.array().square() - v.array());
    parameters.array() -= rate * m.array() / ((v_scale * v.array()).sqrt() + epsilon);
  }
};

}  // namespace bess
