// State machines of connection and order, and old RTU replies that could be mistaken for a new one.
#include "edge/device/battery/link_state.h"

#include <gtest/gtest.h>

#include <string_view>

#include "edge/device/battery/order_state.h"
#include "edge/device/battery/unanswered_requests.h"

namespace bess {
namespace {

constexpr LinkPauses kPauses{.back_off_first_ns = 1,
                             .back_off_max_ns = 60,
                             .connect_delay_ns = 5,
                             .gap_ns = 3,
                             .quiet_ns = 10};

TEST(LinkState, ADeadBatteryIsTriedLessAndLessOften) {
  LinkStateMachine machine(kPauses);
  std::int64_t now = 0;
  for (const std::int64_t pause : {1, 2, 4, 8, 16, 32, 60, 60}) {
    ASSERT_EQ(machine.state(now), LinkState::kDisconnected);
    machine.on_connect_failed(now);
    machine.on_lost(now);  // closing a closed connection shortens nothing
    EXPECT_EQ(machine.state(now + pause - 1), LinkState::kBackingOff) << pause;
    now += pause;
  }
  machine.on_connected(now);
  machine.on_answered(now);
  machine.on_lost(now);
  EXPECT_EQ(machine.state(now), LinkState::kDisconnected);  // a lost connection: immediate retry
  machine.on_connect_failed(now);
  EXPECT_EQ(machine.state(now + 1), LinkState::kDisconnected);  // the pauses restart
}

TEST(LinkState, RequestsKeepTheDevicesPauses) {
  LinkStateMachine machine(kPauses);
  machine.on_connected(100);
  EXPECT_EQ(machine.state(100), LinkState::kConnected);
  EXPECT_EQ(machine.ready_ns(), 105);
  machine.on_answered(110);
  EXPECT_EQ(machine.ready_ns(), 113);
  machine.on_no_answer(120);
  EXPECT_EQ(machine.state(1'000), LinkState::kDraining);  // until the input was discarded
  EXPECT_EQ(machine.ready_ns(), 130);
  machine.on_drained();
  EXPECT_EQ(machine.state(130), LinkState::kConnected);
  machine.on_lost(140);
  machine.on_connected(140);
  EXPECT_EQ(machine.ready_ns(), 145);
}

constexpr ModbusRequest kSoc{.unit = 85, .address = 0x0102, .count = 1};
constexpr ModbusRequest kMode{.unit = 85, .address = 0x0440, .count = 1};
constexpr ModbusRequest kBlock{.unit = 85, .address = 0x0102, .count = 44};

TEST(UnansweredRequests, OnlyWhatCouldBeMistakenWaits) {
  UnansweredRequests unanswered(1'000);
  EXPECT_EQ(unanswered.earliest_ns(kMode), 0);
  unanswered.add(kSoc, 50);
  EXPECT_EQ(unanswered.earliest_ns(kMode), 1'050);
  EXPECT_EQ(unanswered.earliest_ns(kSoc), 0);    // an old answer is the same register
  EXPECT_EQ(unanswered.earliest_ns(kBlock), 0);  // distinguished by its length
}

TEST(UnansweredRequests, AReplyOfAnotherShapeProvesThatTheOldOnesHaveGone) {
  UnansweredRequests unanswered(1'000);
  unanswered.add(kSoc, 50);
  unanswered.on_answered(kBlock, 60);
  EXPECT_TRUE(unanswered.empty());
  EXPECT_EQ(unanswered.earliest_ns(kMode), 0);
}

TEST(UnansweredRequests, AReplyOfTheSameShapeMayHaveBeenTheOldOne) {
  UnansweredRequests unanswered(1'000);
  unanswered.add(kSoc, 50);
  unanswered.on_answered(kSoc, 70);  // then the answer to this one is still pending
  EXPECT_EQ(unanswered.earliest_ns(kMode), 1'070);
  unanswered.forget_old(1'069);
  EXPECT_FALSE(unanswered.empty());
  unanswered.forget_old(1'070);
  EXPECT_TRUE(unanswered.empty());
}

TEST(UnansweredRequests, MoreThanTheListHoldsMakesEveryReadWait) {
  UnansweredRequests unanswered(1'000);
  for (int count = 1; count <= 9; ++count) unanswered.add({.unit = 85, .count = count}, count);
  EXPECT_EQ(unanswered.earliest_ns(kBlock), 1'009);
  unanswered.on_answered(kBlock, 20);
  EXPECT_EQ(unanswered.earliest_ns(kBlock), 1'020);
}

constexpr std::int64_t kSecondNs = kNanosecondsPerSecond;
constexpr Watchdog kHundredSeconds{
    .kind = Watchdog::Kind::kDuration, .duration_s = 100, .refresh_s = 60};

/// The table of events and states, as drawn.
TEST(OrderState, FollowsItsTable) {
  struct Row {
    const char* events;  ///< e enabled, t taken, f fed, l lost, r released
    bool is_enabled, is_in_force, was_ours;
  };
  for (const Row& row :
       {Row{"", false, false, false}, Row{"e", true, false, false}, Row{"el", false, false, false},
        Row{"et", true, true, true}, Row{"etf", true, true, true}, Row{"ett", true, true, true},
        Row{"etl", false, false, true}, Row{"etle", true, false, true},
        Row{"r", false, false, true}, Row{"etr", false, false, true}}) {
    OrderState order(kHundredSeconds);
    for (const char event : std::string_view(row.events)) {
      if (event == 'e') order.on_enabled();
      if (event == 't') order.on_taken(Command::kCharge, {.power_w = 7}, 0);
      if (event == 'f') order.on_fed(0);
      if (event == 'l') order.on_lost();
      if (event == 'r') order.on_released();
    }
    EXPECT_EQ(order.is_enabled(), row.is_enabled) << row.events;
    EXPECT_EQ(order.is_in_force(), row.is_in_force) << row.events;
    EXPECT_EQ(order.was_ours(), row.was_ours) << row.events;
  }
}

TEST(OrderState, ItsTimeRunsFromTheLastRefresh) {
  OrderState order(kHundredSeconds);
  order.on_enabled();
  order.on_taken(Command::kCharge, {}, 0);
  EXPECT_FALSE(order.is_due(30 * kSecondNs - 1));
  EXPECT_TRUE(order.is_due(30 * kSecondNs));
  order.on_fed(30 * kSecondNs);
  EXPECT_FALSE(order.is_due(60 * kSecondNs - 1));
  order.note_seconds_left(59);
  EXPECT_TRUE(order.is_due(31 * kSecondNs));
  EXPECT_TRUE(order.is_within_its_time(120 * kSecondNs - 1));
  EXPECT_FALSE(order.is_within_its_time(120 * kSecondNs));
  EXPECT_TRUE(order.may_last(130 * kSecondNs - 1));
  EXPECT_FALSE(order.may_last(130 * kSecondNs));
  EXPECT_FALSE(order.has_settled(4 * kSecondNs, 5));
  EXPECT_TRUE(order.has_settled(5 * kSecondNs, 5));
  constexpr Watchdog kNoTimer{};
  OrderState stays(kNoTimer);
  stays.on_taken(Command::kCharge, {}, 0);
  EXPECT_TRUE(stays.may_last(INT64_MAX));
  EXPECT_FALSE(stays.is_due(INT64_MAX));
}

/// An expired order is not lost, unless another controller overwrote it.
TEST(OrderState, ALossIsRememberedUntilTheNextOrder) {
  for (const bool is_foreign : {false, true}) {
    for (const std::int64_t now_ns : {1 * kSecondNs, 95 * kSecondNs}) {
      OrderState order(kHundredSeconds);
      order.on_taken(Command::kCharge, {}, 0);
      order.on_lost(OrderLoss::kReplaced, is_foreign, now_ns);
      const bool is_lost = is_foreign || now_ns < 90 * kSecondNs;
      EXPECT_EQ(order.loss(), is_lost ? OrderLoss::kReplaced : OrderLoss::kNone);
      order.on_taken(Command::kCharge, {}, now_ns);
      EXPECT_EQ(order.loss(), OrderLoss::kNone);
    }
  }
}

}  // namespace
}  // namespace bess
