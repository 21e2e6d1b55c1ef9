// Alarms: each once, its end once, over restarts and clocks that step.
#include "edge/companions/notify/notifier_state.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

const SeenAlert kLink{.key = "battery", .text = "WARN battery: found"};
const SeenAlert kPrices{.key = "prices", .text = "WARN prices: found"};

class AlertList {
 public:
  explicit AlertList(std::int64_t after_s, std::vector<ToldAlert> before = {})
      : after_s_(after_s), alerts_(std::move(before)) {}
  std::vector<AlertEvent> observe(const std::vector<SeenAlert>& seen, std::int64_t now_utc_s) {
    return bess::observe(alerts_, seen, after_s_, now_utc_s);
  }
  [[nodiscard]] const std::vector<ToldAlert>& alerts() const { return alerts_; }

 private:
  std::int64_t after_s_;
  std::vector<ToldAlert> alerts_;
};

TEST(Alerts, AShortFaultIsNotReported) {
  AlertList list(300);
  for (int s = 0; s <= 270; s += 30) EXPECT_TRUE(list.observe({kLink}, s).empty());
  for (int s = 300; s <= 1'200; s += 30) EXPECT_TRUE(list.observe({}, s).empty());
  EXPECT_TRUE(list.alerts().empty());
  EXPECT_TRUE(list.observe({kLink}, 1'230).empty());  // another one: counted from here
}

TEST(Alerts, WhatComesAndGoesIsOneTrouble) {
  AlertList list(300);
  int reported = 0;
  for (int s = 0; s < 3'600; s += 30) {
    const bool is_there = s / 120 % 2 == 0;
    reported += static_cast<int>(
        list.observe(is_there ? std::vector{kPrices} : std::vector<SeenAlert>{}, s).size());
  }
  EXPECT_EQ(reported, 1);
}

TEST(Alerts, AClockThatWasInTheFutureSilencesNothing) {
  AlertList list(300);
  list.observe({kLink}, 1'000'000);
  EXPECT_TRUE(list.observe({kLink}, 1'000).empty());
  EXPECT_EQ(list.observe({kLink}, 1'300).size(), 1U);
  list.observe({}, 500);
  EXPECT_EQ(list.observe({}, 800).size(), 1U);
}

TEST(Alerts, TheTextIsTheNewest) {
  AlertList list(60);
  list.observe({{"age", "260 s ago"}}, 0);
  const std::vector<AlertEvent> events = list.observe({{"age", "320 s ago"}}, 60);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].alert.text, "320 s ago");
}

}  // namespace
}  // namespace bess
