// Benchmark registry by name. A peer is registered with its benchmark and runs after it, or reports
// its time from within it when the two alternate.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace bess {

void register_market_benchmarks();
void register_learning_benchmarks();
void register_student_benchmarks();
void register_correction_benchmarks();
void register_edge_benchmarks();

/// Names registered so far, without peers.
std::vector<std::string>& benchmark_names();

/// Registers `body(state)` under `name`, `repetitions` times.
template <typename Body>
benchmark::internal::Benchmark* add_benchmark(const std::string& name, benchmark::TimeUnit unit,
                                              int repetitions, Body body) {
  if (name.find('@') == std::string::npos) benchmark_names().push_back(name);
  return benchmark::RegisterBenchmark(name.c_str(), body)
      ->Unit(unit)
      ->UseRealTime()
      ->Repetitions(repetitions);
}

/// For a peer that alternates with the benchmark: its time in this repetition, in the benchmark's
/// unit; NaN if the peer is missing.
inline void report_peer(benchmark::State& state, const std::string& peer, double time) {
  state.counters["@" + peer] = time;
}

}  // namespace bess
