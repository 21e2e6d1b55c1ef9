// Gradient step benchmarks as in the paper: minibatch 16,384 from a replay of a million, 5-256-128,
// C51 with 51 atoms or DQN, Adam, target blend; and the cost of drawing a minibatch.
#include <chrono>
#include <ctime>
#include <limits>
#include <memory>
#include <thread>

#include "tests/bench/fma_peak.h"
#include "tests/bench/registry.h"
#include "tests/bench/simulated_year.h"
#include "tests/bench/torch_peer.h"
#include "workstation/base/random.h"
#include "workstation/policy/rl/learner.h"
#include "workstation/policy/rl/train.h"

namespace bess {
namespace {

constexpr std::size_t kMinibatch = 16'384;
constexpr std::size_t kReplay = 1'000'000;
constexpr int kRepetitions = 15;
/// Each side takes a few consecutive steps, as in training; the first finds the caches full of the
/// other's data.
constexpr int kStepsInTurn = 4;
constexpr double kGamma = 0.999;
const Support kSupport{-10, 10, 51};

/// Transitions of a full ring, and minibatches drawn from it as Replay::draw does.
class RandomReplay {
 public:
  RandomReplay() : ring_(kReplay) {
    for (Transition& t : ring_) {
      for (float& x : t.state) x = static_cast<float>(random_.uniform());
      for (float& x : t.next_state) x = static_cast<float>(random_.uniform());
      t.reward = static_cast<float>(random_.normal() * 0.1);
      t.action = static_cast<std::int32_t>(random_.index(kActionCount));
      t.terminal = random_.index(100) == 0 ? 1 : 0;
    }
  }
  const MiniBatch& draw() {
    drawn_.resize(kMinibatch);
    for (Transition& drawn : drawn_) drawn = ring_[random_.index(kReplay)];
    fill_minibatch(drawn_, batch_);
    return batch_;
  }

 private:
  Random random_{1};
  std::vector<Transition> ring_;
  std::vector<Transition> drawn_;
  MiniBatch batch_;
};

RandomReplay& random_replay() {
  static RandomReplay replay;
  return replay;
}

/// Operations (twice the multiply-adds) that no exact method can omit: the target network forward
/// with all outputs; the online network forward, and backward to weights and activations for one
/// action.
double flops_of_step(const MlpShape& s) {
  const double hidden = s.inputs * s.hidden1 + s.hidden1 * s.hidden2;
  const double head = s.hidden2 * s.outputs;
  const double forward = hidden + head + hidden + head / kActionCount;
  const double backward =
      2 * head / kActionCount + 2 * s.hidden1 * s.hidden2 + s.inputs * s.hidden1;
  return 2.0 * kMinibatch * (forward + backward);
}

struct StepBenchmark {
  Learner learner;
  std::unique_ptr<TorchPeer> peer;  ///< C51 only

  StepBenchmark(Method method, int threads) : learner(method, kSupport, kGamma, 1, threads) {
    if (method == Method::kC51) peer = std::make_unique<TorchPeer>(threads);
  }
  void step() { benchmark::DoNotOptimize(learner.step(random_replay().draw(), 5e-4, 0.1).loss); }
};

/// One repetition: our steps, the machine's peak, the peer's steps. `on_cpu` is the share of time
/// in which the team's threads ran; the rest was taken by other programs, or with two threads also
/// by serial work.
void run_step(benchmark::State& state, StepBenchmark& bench) {
  const auto start = std::chrono::steady_clock::now();
  const std::clock_t cpu_start = std::clock();
  for (auto _ : state) bench.step();
  const double cpu_s = static_cast<double>(std::clock() - cpu_start) / CLOCKS_PER_SEC;
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  state.counters["on_cpu"] = cpu_s / elapsed.count() / bench.learner.team().size();
  const double gflops =
      1e-9 * kStepsInTurn * flops_of_step(bench.learner.shape()) / elapsed.count();
  state.counters["gflops"] = gflops;
  state.counters["fma_share"] = gflops / fma_peak_gflops(bench.learner.team());
  if (bench.peer == nullptr) return;
  double peer_ms = 0;
  for (int i = 0; i < kStepsInTurn; ++i) {
    peer_ms += bench.peer->step_ms().value_or(std::numeric_limits<double>::quiet_NaN());
  }
  report_peer(state, "pytorch", peer_ms / kStepsInTurn);
  state.SetLabel(bench.peer->blas());
  // The peer's threads spin for a while after a step: wait until they sleep.
  std::this_thread::sleep_for(std::chrono::milliseconds(20));
}

void add_step_benchmark(Method method, int threads) {
  const std::string name =
      std::string(method_name(method)) + "-step-" + std::to_string(threads) + "t";
  auto bench = std::make_shared<std::unique_ptr<StepBenchmark>>();  // made when first run
  add_benchmark(name, benchmark::kMillisecond, kRepetitions, [=](benchmark::State& state) {
    if (*bench == nullptr) {
      *bench = std::make_unique<StepBenchmark>(method, threads);
      for (int warm_up = 0; warm_up < 3; ++warm_up) (*bench)->step();
    }
    run_step(state, **bench);
  })->Iterations(kStepsInTurn);
}

void draw_counterfactual_minibatch(benchmark::State& state) {
  const TrainingMarket market(year_of_steps(),
                              PriceMap::fit(observed_training_prices(year_of_steps())), {},
                              Horizon::kContinuing, {});
  Random random(1);
  std::vector<Transition> drawn;
  MiniBatch batch;
  for (auto _ : state) {
    draw_counterfactual(market, kMinibatch, {}, random, drawn);
    fill_minibatch(drawn, batch);
    benchmark::DoNotOptimize(batch.reward.data());
  }
}

}  // namespace

void register_learning_benchmarks() {
  for (const Method method : {Method::kC51, Method::kDqn}) {
    for (const int threads : {1, 2}) add_step_benchmark(method, threads);
  }
  add_benchmark("minibatch-replay", benchmark::kMillisecond, 5, [](benchmark::State& state) {
    for (auto _ : state) benchmark::DoNotOptimize(random_replay().draw().reward.data());
  });
  add_benchmark("minibatch-counterfactual", benchmark::kMillisecond, 5,
                draw_counterfactual_minibatch);
}

}  // namespace bess
