#include "workstation/policy/rl/c51.h"

namespace bess {

double dqn_tile_gradient(const GradientStep& step, const TileRange& range, DqnTile& tile,
                         PackedGradient& gradient) {
  const MiniBatch& batch = step.batch;
  forward_hidden(step.target, batch.next_state.middleCols(range.first, range.count), tile.net);
  forward_head(step.target, 0, tile.net, tile.q_next);

  const auto x = batch.state.middleCols(range.first, range.count);
  forward_hidden(step.online, x, tile.net);
  forward_head(step.online, range.action, tile.net, tile.q);
  double loss = 0;
  const auto q_next = tile.q_next.rows(kActionCount);
  auto q = tile.q.rows(1);
  for (Eigen::Index n = 0; n < range.count; ++n) {
    const bool terminal = batch.terminal[static_cast<std::size_t>(range.first + n)] != 0;
    const auto advantage = batch.next_advantage.col(range.first + n);
    const float bootstrap = terminal ? 0.0F : step.gamma * (q_next.col(n) + advantage).maxCoeff();
    const float error = q(0, n) - (batch.reward[range.first + n] + bootstrap);
    loss += 0.5 * static_cast<double>(error) * error;
    q(0, n) = error / static_cast<float>(batch.size());
  }
  backward(step.online, range.action, x, q, tile.net, gradient);
  return loss;
}

}  // namespace bess
