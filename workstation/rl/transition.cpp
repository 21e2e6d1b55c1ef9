#include "workstation/rl/transition.h"

namespace bess {

void fill_minibatch(const std::vector<const Transition*>& transitions, MiniBatch& batch) {
  const auto count = static_cast<Eigen::Index>(transitions.size());
  batch.state.resize(kNetworkInputs, count);
  batch.next_state.resize(kNetworkInputs, count);
  batch.reward.resize(count);
  batch.terminal.resize(transitions.size());
  Eigen::Index at = 0;
  for (int action = 0; action < kActionCount; ++action) {
    for (const Transition* t : transitions) {
      if (t->action != action) continue;
      for (int i = 0; i < kNetworkInputs; ++i) {
        batch.state(i, at) = t->state[i];
        batch.next_state(i, at) = t->next_state[i];
      }
      batch.reward[at] = t->reward;
      batch.terminal[static_cast<std::size_t>(at)] = t->terminal;
      ++at;
    }
    batch.group_end[action] = at;
  }
}

}  // namespace bess
