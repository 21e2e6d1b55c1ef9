// One gradient step of the teacher: the minibatch is cut into tiles, each thread sums the gradients
// of its own tiles into its own buffer, the buffers are added in order, Adam moves the weights and
// the target follows. Static split: the same seed, threads and build give the same weights to the
// bit.
#pragma once

#include <vector>

#include "workstation/nn/adam.h"
#include "workstation/nn/thread_team.h"
#include "workstation/rl/c51.h"
#include "workstation/rl/dqn.h"
#include "workstation/rl/teacher.h"

namespace bess {

class Learner {
 public:
  Learner(Method method, const Support& support, double gamma, std::uint64_t seed, int threads);

  struct StepResult {
    double loss;            ///< mean over the minibatch
    double edge_mass_frac;  ///< C51: mean target mass on the two end atoms
  };
  /// Gradient of the mean loss over `batch` at the current weights, into `gradient()`.
  StepResult compute_gradient(const MiniBatch& batch);
  /// compute_gradient, Adam with `learning_rate`, target blended with `tau`.
  StepResult step(const MiniBatch& batch, double learning_rate, double tau);

  [[nodiscard]] const MlpShape& shape() const { return shape_; }
  [[nodiscard]] Parameters& online() { return online_; }
  [[nodiscard]] Parameters& target() { return target_; }
  [[nodiscard]] const Parameters& gradient() const { return workers_[0].gradient; }
  [[nodiscard]] ThreadTeam& team() { return team_; }

 private:
  struct Worker {
    Parameters gradient;
    C51Tile c51;
    DqnTile dqn;
    double loss = 0;
  };
  void run_tiles(const MiniBatch& batch, int worker_index);

  Method method_;
  Support support_;
  float gamma_;
  MlpShape shape_;
  Parameters online_;
  Parameters target_;
  Adam adam_;
  ThreadTeam team_;
  std::vector<Worker> workers_;
};

}  // namespace bess
