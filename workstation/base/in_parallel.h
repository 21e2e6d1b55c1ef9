// The same job for each of many things, on a few threads. Which thread takes what is a matter of
// timing: a job's result must follow from its thing alone.
#pragma once

#include <atomic>
#include <cstddef>
#include <thread>
#include <vector>

namespace bess {

/// Runs job(0) .. job(count - 1); returns when all are done. `job` must not throw.
template <typename Job>
void in_parallel(std::size_t count, int threads, const Job& job) {
  std::atomic<std::size_t> next = 0;
  const auto work = [&] {
    for (std::size_t i = next++; i < count; i = next++) job(i);
  };
  std::vector<std::jthread> others;
  for (int t = 1; t < threads; ++t) others.emplace_back(work);
  work();
}

}  // namespace bess
