#include "tests/bench/fma_peak.h"

#include <benchmark/benchmark.h>

#include <Eigen/Core>

#include <chrono>
#include <cstdint>

namespace bess {
namespace {

using Packet = Eigen::internal::packet_traits<float>::type;
/// Enough to hide the latency of two units; fits 16 registers.
constexpr int kChains = 10;
constexpr std::int64_t kRounds = 1'000'000;

void multiply_add_chains() {
  Packet sum[kChains];
  for (int c = 0; c < kChains; ++c) sum[c] = Eigen::internal::pset1<Packet>(static_cast<float>(c));
  Packet factor = Eigen::internal::pset1<Packet>(0.5F);
  benchmark::DoNotOptimize(factor);
  for (std::int64_t round = 0; round < kRounds; ++round) {
    for (int c = 0; c < kChains; ++c) sum[c] = Eigen::internal::pmadd(sum[c], factor, factor);
  }
  Packet all = sum[0];
  for (int c = 1; c < kChains; ++c) all = Eigen::internal::padd(all, sum[c]);
  benchmark::DoNotOptimize(all);
}

}  // namespace

double fma_peak_gflops(ThreadTeam& team) {
  constexpr std::int64_t kFlops =
      2 * kChains * kRounds * Eigen::internal::packet_traits<float>::size;
  const auto start = std::chrono::steady_clock::now();
  team.run([](int) { multiply_add_chains(); });
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  return 1e-9 * static_cast<double>(kFlops) * team.size() / elapsed.count();
}

}  // namespace bess
