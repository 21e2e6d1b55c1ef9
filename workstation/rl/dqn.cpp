#include "workstation/rl/dqn.h"

namespace bess {

double dqn_tile_gradient(float gamma, const ConstMlp& online, const ConstMlp& target,
                         const MiniBatch& batch, int action, Eigen::Index first, Eigen::Index count,
                         DqnTile& tile, MutableMlp& gradient) {
  forward_hidden(target, batch.next_state.middleCols(first, count), tile.target);
  forward_head(target, tile.target, tile.q_next);

  const auto x = batch.state.middleCols(first, count);
  const auto w3 = online.w3.row(action);
  forward_hidden(online, x, tile.online);
  tile.q.noalias() = w3 * tile.online.h2;
  tile.q.array() += online.b3[action];
  double loss = 0;
  for (Eigen::Index n = 0; n < count; ++n) {
    const bool terminal = batch.terminal[static_cast<std::size_t>(first + n)] != 0;
    const float bootstrap = terminal ? 0.0F : gamma * tile.q_next.col(n).maxCoeff();
    const float error = tile.q(0, n) - (batch.reward[first + n] + bootstrap);
    loss += 0.5 * static_cast<double>(error) * error;
    tile.q(0, n) = error / static_cast<float>(batch.size());
  }
  gradient.w3.row(action).noalias() += tile.q * tile.online.h2.transpose();
  gradient.b3[action] += tile.q.sum();
  tile.online.dh2.noalias() = w3.transpose() * tile.q;
  backward_hidden(online, x, tile.online, gradient);
  return loss;
}

}  // namespace bess
