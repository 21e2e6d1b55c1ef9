#include "workstation/policy/rl/c51.h"

#include <algorithm>

namespace bess {

void fill_minibatch(std::span<const Transition> transitions, MiniBatch& batch) {
  const auto count = static_cast<Eigen::Index>(transitions.size());
  batch.state.resize(kNetworkInputs, count);
  batch.next_state.resize(kNetworkInputs, count);
  batch.next_advantage.resize(kActionCount, count);
  batch.reward.resize(count);
  batch.terminal.resize(transitions.size());
  // Counting sort.
  Eigen::Index taken[kActionCount] = {};
  for (const Transition& t : transitions) ++taken[t.action];
  Eigen::Index next[kActionCount];
  Eigen::Index end = 0;
  for (int action = 0; action < kActionCount; ++action) {
    next[action] = end;
    end += taken[action];
    batch.group_end[action] = end;
  }
  for (const Transition& t : transitions) {
    const Eigen::Index at = next[t.action]++;
    std::copy_n(t.state, kNetworkInputs, batch.state.col(at).data());
    std::copy_n(t.next_state, kNetworkInputs, batch.next_state.col(at).data());
    std::copy_n(t.next_advantage, kActionCount, batch.next_advantage.col(at).data());
    batch.reward[at] = t.reward;
    batch.terminal[static_cast<std::size_t>(at)] = t.terminal;
  }
}

}  // namespace bess
