#include "workstation/rl/learner.h"

#include <algorithm>

namespace bess {
namespace {
/// Samples a tile: its activations stay in the second-level cache.
constexpr Eigen::Index kTileSamples = 512;
}  // namespace

Learner::Learner(Method method, const Support& support, double gamma, std::uint64_t seed,
                 int threads)
    : method_(method),
      support_(support),
      gamma_(static_cast<float>(gamma)),
      shape_(teacher_shape(method, support)),
      online_(initial_parameters(shape_, seed)),
      target_(online_),
      adam_(shape_.parameter_count()),
      team_(threads),
      workers_(static_cast<std::size_t>(threads)) {
  for (Worker& worker : workers_) worker.gradient.setZero(shape_.parameter_count());
}

void Learner::run_tiles(const MiniBatch& batch, int worker_index) {
  Worker& worker = workers_[static_cast<std::size_t>(worker_index)];
  worker.gradient.setZero();
  worker.loss = 0;
  worker.c51.edge_mass = 0;
  const ConstMlp online(shape_, online_.data());
  const ConstMlp target(shape_, target_.data());
  MutableMlp gradient(shape_, worker.gradient.data());
  int tile = 0;
  for (int action = 0; action < kActionCount; ++action) {
    const Eigen::Index end = batch.group_end[action];
    for (Eigen::Index first = batch.group_begin(action); first < end; first += kTileSamples) {
      if (tile++ % team_.size() != worker_index) continue;
      const Eigen::Index count = std::min(kTileSamples, end - first);
      worker.loss += method_ == Method::kC51
                         ? c51_tile_gradient(support_, gamma_, online, target, batch, action, first,
                                             count, worker.c51, gradient)
                         : dqn_tile_gradient(gamma_, online, target, batch, action, first, count,
                                             worker.dqn, gradient);
    }
  }
}

Learner::StepResult Learner::compute_gradient(const MiniBatch& batch) {
  team_.run([&](int worker) { run_tiles(batch, worker); });
  const auto samples = static_cast<double>(batch.size());
  StepResult result{0, 0};
  for (std::size_t w = 0; w < workers_.size(); ++w) {
    if (w > 0) workers_[0].gradient += workers_[w].gradient;
    result.loss += workers_[w].loss / samples;
    result.edge_mass_frac += workers_[w].c51.edge_mass / samples;
  }
  return result;
}

Learner::StepResult Learner::step(const MiniBatch& batch, double learning_rate, double tau) {
  const StepResult result = compute_gradient(batch);
  adam_.update(online_, gradient(), static_cast<float>(learning_rate));
  target_ += static_cast<float>(tau) * (online_ - target_);
  return result;
}

}  // namespace bess
