// Steps in a synthetic recording of a battery with known delay, ramp and lag.
#include "edge/app/recording/energy_evidence.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>

#include "edge/device/battery/step_fit.h"
#include "shared/battery_model.h"
#include "shared/scaled_clock.h"
#include "tests/support/shipped_maps.h"

namespace bess {
namespace {

constexpr double kStandbyW = 35;

/// A constant rise says nothing of its end: that is the order, with 5 % of standard deviation.
TEST(StepFit, AStepSeenForAThirdIsExpectedToReachItsOrder) {
  StepResponse curve(3'000, 150);
  for (int s = 0; s <= 10; ++s) {
    curve.add({.begin_ms = s * 1'000, .end_ms = s * 1'000, .along_w = 100 * s});
  }
  const StepResponse* const two[] = {&curve, &curve};
  const SecondsOfStep seconds = StepFit(two).seconds_until(3'000, 30);
  EXPECT_GT(seconds.least, 30 * (1 - 3 * 0.05));
}

/// Orders and readings of the plain simulated device, as they go over its bus.
class RecordedStepsTest : public ::testing::Test {
 protected:
  void begin(const PowerResponse& response) {
    response_ = response;
    steps_ = std::make_unique<RecordedSteps>(map_, -1, 1);
  }
  void put(std::uint8_t function, std::uint16_t address, std::initializer_list<int> values) {
    BusExchange exchange{.utc_ns = static_cast<std::int64_t>(now_s_ * 1e9),
                         .latency_us = 20'000,
                         .unit = 1,
                         .function = function,
                         .address = address,
                         .count = static_cast<std::uint16_t>(values.size())};
    std::ranges::transform(values, exchange.registers.begin(),
                           [](int v) { return static_cast<std::uint16_t>(v); });
    steps_->add(exchange);
    pass(0.02);
  }
  void pass(double seconds) {
    PowerResponse now = response_;
    now.delay_s = std::max(response_.delay_s - (now_s_ - ordered_s_), 0.0);
    power_ = response_power(now, power_, ordered_w_, seconds).end;
    now_s_ += seconds;
  }
  void order(int power_w) {
    put(16, 100, {1, power_w >> 16, power_w & 0xFFFF, 10'000, 0, 300});
    if (power_w != ordered_w_) ordered_s_ = now_s_;
    ordered_w_ = power_w;
  }
  void read_for(int seconds, double every_s = 1) {
    for (double passed_s = 0; passed_s < seconds; passed_s += every_s) {
      pass(every_s - 0.02);
      const int w = static_cast<int>(
          std::lround(std::clamp(power_.flowing_w, -3'900.0, 3'900.0) + kStandbyW));
      put(3, 11, {w >> 16, w & 0xFFFF});
    }
  }
  /// As bess-edge commission drives it.
  void drive() {
    for (const int power_w : {0, 500, 0, -500, 0, 3'000, -3'000, 3'000, 0}) {
      order(power_w);
      read_for(20);
      order(power_w);  // refreshed
      read_for(25);
    }
  }

  RegisterMap map_ = load_shipped_map({"simulator", ""});
  PowerResponse response_;
  std::unique_ptr<RecordedSteps> steps_;
  PowerState power_;
  double now_s_ = 1'679'788'800, ordered_s_ = 0;
  int ordered_w_ = 0;
};

TEST_F(RecordedStepsTest, ShowDelayRampAndLagWithinThreePercent) {
  const PowerResponse cases[] = {
      {.delay_s = 2, .ramp_w_per_s = 500, .time_constant_s = 3},
      {.delay_s = 4, .ramp_w_per_s = 0, .time_constant_s = 5},
      {.delay_s = 3, .ramp_w_per_s = 800, .time_constant_s = 0},
  };
  constexpr double kNoLagS = 0.1;  // indistinguishable from the delay
  for (const PowerResponse& real : cases) {
    SCOPED_TRACE(real.delay_s);
    begin(real);
    drive();
    const auto whole = steps_->whole();
    ASSERT_EQ(whole.size(), 8U);
    const StepFit fit(whole);
    EXPECT_EQ(fit.has_ramp(), real.ramp_w_per_s > 0);
    if (fit.has_ramp()) {
      EXPECT_NEAR(1 / fit.best().ramp_s_per_w, real.ramp_w_per_s, 0.03 * real.ramp_w_per_s);
    }
    EXPECT_NEAR(fit.best().dead_time_s, real.delay_s, 0.03 * real.delay_s);
    EXPECT_NEAR(fit.best().time_constant_s, real.time_constant_s,
                real.time_constant_s > 0 ? 0.03 * real.time_constant_s : kNoLagS);
  }
}

TEST_F(RecordedStepsTest, WhatShowsNoWholeStepIsLeftOut) {
  begin({.time_constant_s = 2});
  order(1'000);
  read_for(30);
  EXPECT_TRUE(steps_->whole().empty()) << "from an unknown order";
  order(-1'000);
  read_for(3);
  order(1'000);
  read_for(30);
  EXPECT_EQ(steps_->orders(), 2);
  EXPECT_TRUE(steps_->whole().empty()) << "truncated, and begun before the last one ended";
  order(3'000);
  read_for(120, 60);
  EXPECT_TRUE(steps_->whole().empty()) << "seldom read";
  order(-3'800);
  read_for(30);
  ASSERT_EQ(steps_->whole().size(), 1U);
  EXPECT_EQ(steps_->whole()[0]->step_w(), 6'800);
  order(8'000);  // 3,900 arrive
  read_for(60);
  EXPECT_EQ(steps_->whole().size(), 1U) << "held back";
}

TEST_F(RecordedStepsTest, AfterAReleaseNoOrderIsKnown) {
  begin({.time_constant_s = 1});
  order(0);
  read_for(10);
  order(2'000);
  read_for(30);
  put(16, 100, {0, 0, 0});
  read_for(30);
  order(1'000);
  read_for(30);
  EXPECT_EQ(steps_->whole().size(), 1U);
  EXPECT_EQ(steps_->orders(), 1);
}

}  // namespace
}  // namespace bess
