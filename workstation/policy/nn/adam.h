// Adam [Kingma, Ba 2015, Algorithm 1] over one flat parameter vector.
#pragma once

#include <cmath>

#include "workstation/policy/nn/mlp.h"

namespace bess {

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
