// Reference net: the network and the two losses in double, one row at a time with plain loops,
// written from the papers without shared code. Also random minibatches, drawn so that float and
// double cannot diverge: no sample is on a kink of a ReLU or a tie of an argmax.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>
#include <vector>

#include "workstation/base/random.h"
#include "workstation/policy/rl/c51.h"

namespace bess {

using Doubles = std::vector<double>;

inline Doubles to_doubles(const Parameters& values) {
  return Doubles(values.data(), values.data() + values.size());
}

/// One fully connected layer inside a flat vector: weights column-major, then biases.
struct ReferenceLayer {
  std::size_t rows, columns, at;

  [[nodiscard]] std::size_t bias() const { return at + rows * columns; }
  [[nodiscard]] std::size_t end() const { return bias() + rows; }

  [[nodiscard]] Doubles forward(const Doubles& parameters, const Doubles& x) const {
    Doubles y(rows);
    for (std::size_t i = 0; i < rows; ++i) y[i] = parameters[bias() + i];
    for (std::size_t j = 0; j < columns; ++j) {
      for (std::size_t i = 0; i < rows; ++i) y[i] += parameters[at + j * rows + i] * x[j];
    }
    return y;
  }
  /// Adds to `gradient`, returns dL/dx.
  [[nodiscard]] Doubles backward(const Doubles& parameters, const Doubles& x, const Doubles& dy,
                                 Doubles& gradient) const {
    Doubles dx(columns, 0.0);
    for (std::size_t i = 0; i < rows; ++i) gradient[bias() + i] += dy[i];
    for (std::size_t j = 0; j < columns; ++j) {
      for (std::size_t i = 0; i < rows; ++i) {
        gradient[at + j * rows + i] += dy[i] * x[j];
        dx[j] += parameters[at + j * rows + i] * dy[i];
      }
    }
    return dx;
  }
};

struct ReferenceNet {
  ReferenceLayer first, second, head;
  Doubles parameters;

  ReferenceNet(const MlpShape& shape, Doubles values)
      : first{size(shape.hidden1), size(shape.inputs), 0},
        second{size(shape.hidden2), size(shape.hidden1), first.end()},
        head{size(shape.outputs), size(shape.hidden2), second.end()},
        parameters(std::move(values)) {}

  struct Pass {
    Doubles x, before1, h1, before2, h2, z;
  };
  [[nodiscard]] Pass forward(const Doubles& x) const {
    Pass pass;
    pass.x = x;
    pass.before1 = first.forward(parameters, x);
    pass.h1 = relu(pass.before1);
    pass.before2 = second.forward(parameters, pass.h1);
    pass.h2 = relu(pass.before2);
    pass.z = head.forward(parameters, pass.h2);
    return pass;
  }
  void backward(const Pass& pass, const Doubles& dz, Doubles& gradient) const {
    Doubles d2 = head.backward(parameters, pass.h2, dz, gradient);
    for (std::size_t i = 0; i < d2.size(); ++i) d2[i] = pass.before2[i] > 0 ? d2[i] : 0;
    Doubles d1 = second.backward(parameters, pass.h1, d2, gradient);
    for (std::size_t i = 0; i < d1.size(); ++i) d1[i] = pass.before1[i] > 0 ? d1[i] : 0;
    (void)first.backward(parameters, pass.x, d1, gradient);
  }

 private:
  static std::size_t size(int n) { return static_cast<std::size_t>(n); }
  static Doubles relu(Doubles x) {
    for (double& value : x) value = std::max(value, 0.0);
    return x;
  }
};

inline Doubles inputs_of(const float* x) { return Doubles(x, x + kNetworkInputs); }

struct ReferenceLoss {
  double loss = 0;         ///< mean over the batch
  double edge_mass = 0;    ///< C51: mean target mass on the two end atoms
  double low_clipped = 0;  ///< C51: atoms below the support
  double high_clipped = 0;
  Doubles gradient;
};

inline Doubles reference_softmax(const Doubles& z, std::size_t first, std::size_t count) {
  const double largest = *std::max_element(z.begin() + static_cast<long>(first),
                                           z.begin() + static_cast<long>(first + count));
  Doubles p(count);
  for (std::size_t i = 0; i < count; ++i) p[i] = std::exp(z[first + i] - largest);
  const double sum = std::accumulate(p.begin(), p.end(), 0.0);
  for (double& value : p) value /= sum;
  return p;
}

/// Mean value of each action from the logits of all [Bellemare 2017, Algorithm 1, first line].
inline Doubles reference_means(const Support& support, const Doubles& logits) {
  const auto count = static_cast<std::size_t>(support.count);
  const double low = support.v_min;
  const double step = (double{support.v_max} - low) / static_cast<double>(count - 1);
  Doubles means;
  for (std::size_t a = 0; a < kActionCount; ++a) {
    const Doubles p = reference_softmax(logits, a * count, count);
    double mean = 0;
    for (std::size_t i = 0; i < count; ++i) mean += (low + static_cast<double>(i) * step) * p[i];
    means.push_back(mean);
  }
  return means;
}

inline std::size_t largest_of(const Doubles& values) {
  return static_cast<std::size_t>(std::max_element(values.begin(), values.end()) - values.begin());
}

/// Bellemare 2017, Algorithm 1; where b_j is a whole number its mass goes to that atom (the printed
/// algorithm drops it).
inline Doubles reference_projection(const Support& support, const Doubles& p, double reward,
                                    double discount, ReferenceLoss* clips = nullptr) {
  const double low = support.v_min;
  const double high = support.v_max;
  const double step = (high - low) / (support.count - 1);
  Doubles m(p.size(), 0.0);
  for (std::size_t j = 0; j < p.size(); ++j) {
    const double wanted = reward + discount * (low + static_cast<double>(j) * step);
    if (clips != nullptr && wanted < low) ++clips->low_clipped;
    if (clips != nullptr && wanted > high) ++clips->high_clipped;
    const double b = (std::min(std::max(wanted, low), high) - low) / step;
    const double lower = std::floor(b);
    const double upper = std::min(std::ceil(b), static_cast<double>(support.count - 1));
    if (lower >= upper) {
      m[static_cast<std::size_t>(upper)] += p[j];
    } else {
      m[static_cast<std::size_t>(lower)] += p[j] * (upper - b);
      m[static_cast<std::size_t>(upper)] += p[j] * (b - lower);
    }
  }
  return m;
}

inline ReferenceLoss reference_c51(const Support& support, double gamma, const ReferenceNet& online,
                                   const ReferenceNet& target, const std::vector<Transition>& batch,
                                   double mean_weight = 0) {
  const auto count = static_cast<std::size_t>(support.count);
  const auto samples = static_cast<double>(batch.size());
  ReferenceLoss result;
  result.gradient.assign(online.parameters.size(), 0.0);
  for (const Transition& t : batch) {
    const Doubles next = target.forward(inputs_of(t.next_state)).z;
    Doubles values = reference_means(support, next);
    for (std::size_t a = 0; a < kActionCount; ++a) values[a] += double{t.next_advantage[a]};
    const std::size_t best = largest_of(values);
    const double discount = t.terminal != 0 ? 0.0 : gamma;
    // Atom z of the residual represents the value A(s', a*) + z: Algorithm 1 moves the whole of it.
    const Doubles m = reference_projection(
        support, reference_softmax(next, best * count, count),
        double{t.reward} + discount * double{t.next_advantage[best]}, discount, &result);
    result.edge_mass += (m.front() + m.back()) / samples;
    const ReferenceNet::Pass pass = online.forward(inputs_of(t.state));
    const std::size_t at = static_cast<std::size_t>(t.action) * count;
    const Doubles p = reference_softmax(pass.z, at, count);
    double mean = 0;
    double error = 0;
    for (std::size_t i = 0; i < count; ++i) {
      mean += p[i] * support.atom(static_cast<int>(i));
      error += (p[i] - m[i]) * support.atom(static_cast<int>(i));
    }
    result.loss += 0.5 * mean_weight * error * error / samples;
    Doubles dz(pass.z.size(), 0.0);
    for (std::size_t i = 0; i < count; ++i) {
      const double apart = support.atom(static_cast<int>(i)) - mean;
      result.loss -= m[i] * std::log(p[i]) / samples;
      dz[at + i] = (p[i] - m[i] + mean_weight * error * p[i] * apart) / samples;
    }
    online.backward(pass, dz, result.gradient);
  }
  return result;
}

inline ReferenceLoss reference_dqn(double gamma, const ReferenceNet& online,
                                   const ReferenceNet& target,
                                   const std::vector<Transition>& batch) {
  const auto samples = static_cast<double>(batch.size());
  ReferenceLoss result;
  result.gradient.assign(online.parameters.size(), 0.0);
  for (const Transition& t : batch) {
    const Doubles next = target.forward(inputs_of(t.next_state)).z;
    Doubles values = next;
    for (std::size_t a = 0; a < kActionCount; ++a) values[a] += double{t.next_advantage[a]};
    const double bootstrap = t.terminal != 0 ? 0.0 : gamma * values[largest_of(values)];
    const ReferenceNet::Pass pass = online.forward(inputs_of(t.state));
    const auto action = static_cast<std::size_t>(t.action);
    const double error = pass.z[action] - (t.reward + bootstrap);
    result.loss += 0.5 * error * error / samples;
    Doubles dz(pass.z.size(), 0.0);
    dz[action] = error / samples;
    online.backward(pass, dz, result.gradient);
  }
  return result;
}

/// |a - b| / |b| in the 2-norm.
inline double relative_l2(const Parameters& a, const Doubles& b) {
  double difference = 0;
  double norm = 0;
  for (std::size_t i = 0; i < b.size(); ++i) {
    const double d = double{a[static_cast<Eigen::Index>(i)]} - b[i];
    difference += d * d;
    norm += b[i] * b[i];
  }
  return std::sqrt(difference / std::max(norm, 1e-300));
}

/// Largest |a - b| over the largest |b|.
inline double max_relative_error(const float* a, const Doubles& b) {
  double error = 0;
  double scale = 1e-300;
  for (std::size_t i = 0; i < b.size(); ++i) {
    error = std::max(error, std::abs(double{a[i]} - b[i]));
    scale = std::max(scale, std::abs(b[i]));
  }
  return error / scale;
}

/// Parameters with a stronger head than at the start, so that distributions have a shape.
inline Parameters random_parameters(const MlpShape& shape, std::uint64_t seed, float head_scale) {
  Parameters parameters = initial_parameters(shape, seed);
  parameters.tail(static_cast<Eigen::Index>(shape.outputs) * (shape.hidden2 + 1)) *= head_scale;
  return parameters;
}

struct BatchRecipe {
  std::size_t group[kActionCount];
  double reward_deviation;
  double terminal_share = 0.15;
  double advantage_deviation = 0;  ///< base values of a residual, in the next state
};

/// Shuffled random transitions with `recipe.group[a]` samples of action a. `support` for C51.
inline std::vector<Transition> random_transitions(const BatchRecipe& recipe,
                                                  const std::optional<Support>& support,
                                                  const ReferenceNet& online,
                                                  const ReferenceNet& target, Random& random) {
  constexpr double kKinkDistance = 3e-6;
  constexpr double kTieDistance = 1e-4;
  const auto near_zero = [](double value) { return std::abs(value) < kKinkDistance; };
  const auto is_safe = [&](const Transition& t) {
    const ReferenceNet::Pass pass = online.forward(inputs_of(t.state));
    if (std::ranges::any_of(pass.before1, near_zero)) return false;
    if (std::ranges::any_of(pass.before2, near_zero)) return false;
    Doubles values = target.forward(inputs_of(t.next_state)).z;
    if (support) values = reference_means(*support, values);
    for (std::size_t a = 0; a < kActionCount; ++a) values[a] += double{t.next_advantage[a]};
    std::ranges::sort(values);
    return values[kActionCount - 1] - values[kActionCount - 2] > kTieDistance;
  };
  std::vector<Transition> batch;
  for (int action = 0; action < kActionCount; ++action) {
    for (std::size_t n = 0; n < recipe.group[action]; ++n) {
      Transition t{};
      do {
        for (float& x : t.state) x = static_cast<float>(random.uniform());
        for (float& x : t.next_state) x = static_cast<float>(random.uniform());
        if (recipe.advantage_deviation > 0) {
          for (float& x : t.next_advantage) {
            x = -std::abs(static_cast<float>(random.normal() * recipe.advantage_deviation));
          }
        }
      } while (!is_safe(t));
      t.reward = static_cast<float>(random.normal() * recipe.reward_deviation);
      t.action = action;
      t.terminal = random.uniform() < recipe.terminal_share ? 1 : 0;
      batch.push_back(t);
    }
  }
  for (std::size_t i = batch.size(); i > 1; --i) std::swap(batch[i - 1], batch[random.index(i)]);
  return batch;
}

inline MiniBatch minibatch_of(const std::vector<Transition>& transitions) {
  MiniBatch batch;
  fill_minibatch(transitions, batch);
  return batch;
}

}  // namespace bess
