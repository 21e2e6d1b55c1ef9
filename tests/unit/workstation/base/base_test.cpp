#include "workstation/data/market/model/simulated_market.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <chrono>
#include <stdexcept>

#include "workstation/base/parallel_for.h"
#include "workstation/base/progress.h"

namespace bess {
namespace {

using testing::EndsWith;
using testing::HasSubstr;

TEST(Random, FirstNumbersAreFixedForEveryMachine) {
  Random random(5489);
  EXPECT_DOUBLE_EQ(random.uniform(),
                   static_cast<double>(14514284786278117030ull >> 11) * 0x1.0p-53);
}

TEST(Random, NormalHasMeanZeroAndDeviationOne) {
  Random random(3);
  constexpr int kCount = 200'000;
  double sum = 0, squares = 0, beyond_two = 0;
  for (int i = 0; i < kCount; ++i) {
    const double value = random.normal();
    sum += value;
    squares += value * value;
    beyond_two += value > 2 ? 1 : 0;
  }
  EXPECT_NEAR(sum / kCount, 0, 0.01);
  EXPECT_NEAR(squares / kCount, 1, 0.02);
  EXPECT_NEAR(beyond_two / kCount, 0.02275, 0.002);
}

TEST(Random, AutoregressionKeepsVarianceAndCorrelation) {
  Random random(4);
  UnitAutoregression process(0.8);
  constexpr int kCount = 200'000;
  double squares = 0, products = 0, before = process.next(random);
  for (int i = 0; i < kCount; ++i) {
    const double value = process.next(random);
    squares += value * value;
    products += value * before;
    before = value;
  }
  EXPECT_NEAR(squares / kCount, 1, 0.03);
  EXPECT_NEAR(products / kCount, 0.8, 0.03);
}

TEST(ProgressLine, ShowsDoneRateAndTheRest) {
  EXPECT_EQ(
      progress_line("verify", "contexts", {.done = 120, .total = 420, .rate_per_s = 10}, "", 80),
      "verify: 120/420 contexts (10/s, ETA 30 s)");
  EXPECT_EQ(progress_line("verify", "contexts", {420, 420, 10, 42.4, true}, "", 80),
            "verify: 420/420 contexts (10/s, 42 s)");
  EXPECT_THAT(progress_line("train", "steps", {1, 8000, 0.5, 2}, "", 80),
              HasSubstr("ETA 4 h 26 min"));
  EXPECT_THAT(progress_line("train", "steps", {1, 2000, 1, 1}, "", 80), HasSubstr("ETA 33 min"));
  EXPECT_THAT(progress_line("train", "steps", {0, 8000, 0, 2}, "", 80), HasSubstr("ETA unknown"));
  EXPECT_THAT(progress_line("train", "steps", {0, 8000, 5853.2, 2}, "", 80), HasSubstr("(5853/s"));
}

TEST(ProgressLine, FitsItsRowAndTheNoteGivesWayFirst) {
  const ProgressState state{.done = 1234, .total = 8000, .rate_per_s = 23.4};
  const std::string note = "loss 1.2345, profit 480.1";
  const std::string whole = progress_line("train c51", "steps", state, note, 80);
  EXPECT_THAT(whole, EndsWith(note));
  for (std::size_t columns = 1; columns < 100; ++columns) {
    EXPECT_LE(progress_line("train c51", "steps", state, note, columns).size(), columns);
  }
  EXPECT_THAT(progress_line("train c51", "steps", state, note, 60), HasSubstr("ETA 289 s)  loss"));
  EXPECT_THAT(progress_line("train c51", "steps", state, note, 50), EndsWith("ETA 289 s)"));
  EXPECT_THAT(progress_line("fetch", "windows", state, "two\nlines\x1b[2J", 80),
              testing::Not(HasSubstr("\n")));
}

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
