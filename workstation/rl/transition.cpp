#include "workstation/rl/transition.h"

#include <algorithm>
#include <ranges>

namespace bess {
namespace {

/// `transitions` is anything that can be walked twice and knows its size.
template <typename Transitions>
void group_by_action(const Transitions& transitions, MiniBatch& batch) {
  const auto count = static_cast<Eigen::Index>(transitions.size());
  batch.state.resize(kNetworkInputs, count);
  batch.next_state.resize(kNetworkInputs, count);
  batch.reward.resize(count);
  batch.terminal.resize(transitions.size());
  // Counting sort. The first pass also fetches the records: from a ring of a million each is a cache
  // miss, and as the pass depends on nothing else, many are under way at once.
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
    batch.reward[at] = t.reward;
    batch.terminal[static_cast<std::size_t>(at)] = t.terminal;
  }
}

}  // namespace

void fill_minibatch(std::span<const Transition> transitions, MiniBatch& batch) {
  group_by_action(transitions, batch);
}

void fill_minibatch(std::span<const Transition> ring, std::span<const std::uint32_t> slots,
                    MiniBatch& batch) {
  const auto in_slot = [ring](std::uint32_t slot) -> const Transition& { return ring[slot]; };
  group_by_action(slots | std::views::transform(in_slot), batch);
}

}  // namespace bess
