#include "workstation/policy/rl/learner.h"

#include <algorithm>

namespace bess {
namespace {

/// Maximum samples per tile: the activations stay in the second-level cache.
constexpr Eigen::Index kTileSamples = 256;

}  // namespace

Learner::Learner(Method method, const Support& support, double gamma, std::uint64_t seed,
                 int threads, double mean_weight)
    : method_(method),
      gamma_(static_cast<float>(gamma)),
      mean_weight_(static_cast<float>(mean_weight)),
      shape_(teacher_shape(method, support)),
      online_(initial_parameters(shape_, seed)),
      target_(online_),
      gradient_(shape_.parameter_count()),
      adam_(shape_.parameter_count()),
      team_(threads),
      workers_(static_cast<std::size_t>(threads), Worker(support)) {}

void Learner::pack_weights() {
  const ConstMlp online(shape_, online_.data());
  const ConstMlp target(shape_, target_.data());
  team_.run([&](int worker) {
    if (worker == 0) packed_online_.pack(online, kActionCount, PackedMlp::Use::kForwardAndBackward);
    if (worker == team_.size() - 1) packed_target_.pack(target, 1, PackedMlp::Use::kForward);
  });
}

void Learner::run_tiles(const MiniBatch& batch, int worker_index) {
  Worker& worker = workers_[static_cast<std::size_t>(worker_index)];
  worker.gradient.set_zero(shape_, kActionCount);
  worker.loss = 0;
  worker.c51.edge_mass = 0;
  const GradientStep step{packed_online_, packed_target_, batch, gamma_, mean_weight_};
  const Eigen::Index own_begin = batch.size() * worker_index / team_.size();
  const Eigen::Index own_end = batch.size() * (worker_index + 1) / team_.size();
  for (int action = 0; action < kActionCount; ++action) {
    const Eigen::Index begin = std::max(own_begin, batch.group_begin(action));
    const Eigen::Index count = std::min(own_end, batch.group_end[action]) - begin;
    const Eigen::Index tiles = (std::max<Eigen::Index>(count, 0) + kTileSamples - 1) / kTileSamples;
    for (Eigen::Index t = 0; t < tiles; ++t) {  // of about equal size
      const Eigen::Index first = begin + count * t / tiles;
      const TileRange range{action, first, begin + count * (t + 1) / tiles - first};
      worker.loss += method_ == Method::kC51
                         ? c51_tile_gradient(step, range, worker.c51, worker.gradient)
                         : dqn_tile_gradient(step, range, worker.dqn, worker.gradient);
    }
  }
}

Learner::StepResult Learner::compute_gradient(const MiniBatch& batch) {
  pack_weights();
  team_.run([&](int worker) { run_tiles(batch, worker); });
  const auto samples = static_cast<double>(batch.size());
  StepResult result{0, 0};
  gradient_.setZero();
  MutableMlp gradient(shape_, gradient_.data());
  for (const Worker& worker : workers_) {
    worker.gradient.add_to(gradient);
    result.loss += worker.loss / samples;
    result.edge_mass_frac += worker.c51.edge_mass / samples;
  }
  return result;
}

Learner::StepResult Learner::step(const MiniBatch& batch, double learning_rate, double tau) {
  const StepResult result = compute_gradient(batch);
  adam_.update(online_, gradient(), static_cast<float>(learning_rate));
  target_ += static_cast<float>(tau) * (online_ - target_);
  return result;
}

void Learner::save(BinaryWriter& out) const {
  out.put(static_cast<std::int64_t>(adam_.step));
  for (const Parameters* p : {&online_, &target_, &adam_.m, &adam_.v}) put_parameters(out, *p);
}

void Learner::restore(BinaryReader& in) {
  adam_.step = in.take<std::int64_t>();
  for (Parameters* p : {&online_, &target_, &adam_.m, &adam_.v}) take_parameters(in, *p);
}

}  // namespace bess
