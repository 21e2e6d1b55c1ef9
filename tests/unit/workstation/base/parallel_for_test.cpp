#include "workstation/base/parallel_for.h"

#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>

namespace bess {
namespace {

TEST(InParallel, EachIsDoneOnceOnHoweverManyThreads) {
  for (const int threads : {1, 2, 7}) {
    std::vector<int> times(100);
    parallel_for(times.size(), threads, [&](std::size_t i) { ++times[i]; });
    EXPECT_EQ(times, std::vector<int>(100, 1)) << threads;
  }
}

TEST(InParallel, AfterAFailureNoOtherBeginsAndItIsThrownAgain) {
  constexpr int kJobs = 1'000;
  for (const int threads : {1, 3}) {
    std::atomic<int> begun = 0;
    const auto job = [&](std::size_t) {
      if (++begun == 1) throw std::runtime_error("the first");
      std::this_thread::sleep_for(std::chrono::milliseconds(20));
    };
    EXPECT_THROW(parallel_for(kJobs, threads, job), std::runtime_error);
    EXPECT_LT(begun, kJobs) << threads;
  }
}

}  // namespace
}  // namespace bess
