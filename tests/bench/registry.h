// The benchmarks by name: each file registers its own; a peer is registered beside the benchmark it is
// measured against, and runs in the same process.
#pragma once

#include <benchmark/benchmark.h>

#include <string>
#include <vector>

namespace bess {

void register_market_benchmarks();
void register_learning_benchmarks();
void register_student_benchmarks();
void register_correction_benchmarks();

/// Names registered so far, peers left out.
std::vector<std::string>& benchmark_names();

/// Registers `body(state)` under `name`, `repetitions` times.
template <typename Body>
void add_benchmark(const std::string& name, benchmark::TimeUnit unit, int repetitions, Body body) {
  if (name.find('@') == std::string::npos) benchmark_names().push_back(name);
  benchmark::RegisterBenchmark(name.c_str(), body)
      ->Unit(unit)
      ->UseRealTime()
      ->Repetitions(repetitions);
}

}  // namespace bess
