// One C51 gradient step as the paper takes it: minibatch 16,384, 5-256-128-153, Adam, target blend.
#include "tests/bench/registry.h"
#include "workstation/io/random.h"
#include "workstation/rl/learner.h"

namespace bess {
namespace {

constexpr std::size_t kMinibatch = 16'384;
constexpr int kRepetitions = 9;

MiniBatch random_minibatch() {
  Random random(1);
  std::vector<Transition> transitions(kMinibatch);
  std::vector<const Transition*> pointers;
  for (Transition& t : transitions) {
    for (float& x : t.state) x = static_cast<float>(random.uniform());
    for (float& x : t.next_state) x = static_cast<float>(random.uniform());
    t.reward = static_cast<float>(random.normal() * 0.1);
    t.action = static_cast<std::int32_t>(random.index(kActionCount));
    t.terminal = random.index(100) == 0 ? 1 : 0;
    pointers.push_back(&t);
  }
  MiniBatch batch;
  fill_minibatch(pointers, batch);
  return batch;
}

void c51_step(benchmark::State& state, int threads) {
  const Support support{-10, 10, 51};
  Learner learner(Method::kC51, support, 0.999, 1, threads);
  const MiniBatch batch = random_minibatch();
  for (auto _ : state) benchmark::DoNotOptimize(learner.step(batch, 5e-4, 0.1).loss);
}

}  // namespace

void register_learning_benchmarks() {
  for (const int threads : {1, 2}) {
    add_benchmark("c51-step-" + std::to_string(threads) + "t", benchmark::kMillisecond,
                  kRepetitions, [threads](benchmark::State& state) { c51_step(state, threads); });
  }
}

}  // namespace bess
