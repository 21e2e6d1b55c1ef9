// Learner: one gradient step of the teacher. Each thread takes an equal part of the minibatch,
// divides it into tiles and sums their gradients into its own buffer; the buffers are added in
// order, Adam updates the weights and the target follows. Static split: the same seed, threads and
// build give bit-identical weights.
#pragma once

#include <vector>

#include "workstation/base/binary_file.h"
#include "workstation/policy/nn/mlp.h"
#include "workstation/policy/nn/thread_team.h"
#include "workstation/policy/rl/c51.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {

class Learner {
 public:
  /// `mean_weight`: see c51_tile_gradient.
  Learner(Method method, const Support& support, double gamma, std::uint64_t seed, int threads,
          double mean_weight = 0);

  struct StepResult {
    double loss;            ///< mean over the minibatch
    double edge_mass_frac;  ///< C51: mean target probability on the two end atoms
  };
  /// Gradient of the mean loss over `batch` at the current weights, into `gradient()`.
  StepResult compute_gradient(const MiniBatch& batch);
  /// compute_gradient, Adam with `learning_rate`, target blended with `tau`.
  StepResult step(const MiniBatch& batch, double learning_rate, double tau);

  [[nodiscard]] const MlpShape& shape() const { return shape_; }
  [[nodiscard]] Parameters& online() { return online_; }
  [[nodiscard]] Parameters& target() { return target_; }
  [[nodiscard]] const Parameters& gradient() const { return gradient_; }
  [[nodiscard]] ThreadTeam& team() { return team_; }

  /// Weights, target and Adam's moments: the full state of the learner.
  void save(BinaryWriter& out) const;
  void restore(BinaryReader& in);

 private:
  struct Worker {
    explicit Worker(const Support& support) : c51(support) {}
    PackedGradient gradient;
    C51Tile c51;
    DqnTile dqn;
    double loss = 0;
  };
  void pack_weights();
  void run_tiles(const MiniBatch& batch, int worker_index);

  Method method_;
  float gamma_;
  float mean_weight_;
  MlpShape shape_;
  Parameters online_;
  Parameters target_;
  PackedMlp packed_online_;
  PackedMlp packed_target_;
  Parameters gradient_;
  Adam adam_;
  ThreadTeam team_;
  std::vector<Worker> workers_;
};

}  // namespace bess
