#include "workstation/policy/rl/transition.h"

#include <algorithm>

namespace bess {
namespace {

/// `transition_of(i)` is transition i of `size`; each is requested twice.
template <typename TransitionOf>
void group_by_action(std::size_t size, const TransitionOf& transition_of, MiniBatch& batch) {
  const auto count = static_cast<Eigen::Index>(size);
  batch.state.resize(kNetworkInputs, count);
  batch.next_state.resize(kNetworkInputs, count);
  batch.next_advantage.resize(kActionCount, count);
  batch.reward.resize(count);
  batch.terminal.resize(size);
  // Counting sort. The first pass also fetches the records: from a ring of a million each is a
  // cache miss, and many are fetched in parallel.
  Eigen::Index taken[kActionCount] = {};
  for (std::size_t i = 0; i < size; ++i) ++taken[transition_of(i).action];
  Eigen::Index next[kActionCount];
  Eigen::Index end = 0;
  for (int action = 0; action < kActionCount; ++action) {
    next[action] = end;
    end += taken[action];
    batch.group_end[action] = end;
  }
  for (std::size_t i = 0; i < size; ++i) {
    const Transition& t = transition_of(i);
    const Eigen::Index at = next[t.action]++;
    std::copy_n(t.state, kNetworkInputs, batch.state.col(at).data());
    std::copy_n(t.next_state, kNetworkInputs, batch.next_state.col(at).data());
    std::copy_n(t.next_advantage, kActionCount, batch.next_advantage.col(at).data());
    batch.reward[at] = t.reward;
    batch.terminal[static_cast<std::size_t>(at)] = t.terminal;
  }
}

}  // namespace

void fill_minibatch(std::span<const Transition> transitions, MiniBatch& batch) {
  const auto at = [transitions](std::size_t i) -> const Transition& { return transitions[i]; };
  group_by_action(transitions.size(), at, batch);
}

void fill_minibatch(std::span<const Transition> ring, std::span<const std::uint32_t> slots,
                    MiniBatch& batch) {
  const auto in_slot = [&](std::size_t i) -> const Transition& { return ring[slots[i]]; };
  group_by_action(slots.size(), in_slot, batch);
}

}  // namespace bess
