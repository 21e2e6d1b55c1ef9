// The connection's state machine, and which old RTU replies could be mistaken for a new one.
#include "edge/battery/link_state.h"

#include <gtest/gtest.h>

#include "edge/battery/unanswered_requests.h"

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
    machine.on_lost(now);  // closing what is not open shortens nothing
    EXPECT_EQ(machine.state(now + pause - 1), LinkState::kBackingOff) << pause;
    now += pause;
  }
  machine.on_connected(now);
  machine.on_answered(now);
  machine.on_lost(now);
  EXPECT_EQ(machine.state(now), LinkState::kDisconnected);  // a lost connection is mended at once
  machine.on_connect_failed(now);
  EXPECT_EQ(machine.state(now + 1), LinkState::kDisconnected);  // the pauses begin anew
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
  EXPECT_EQ(unanswered.earliest_ns(kBlock), 0);  // told apart by its length
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
  unanswered.on_answered(kSoc, 70);  // then the answer to this one is still to come
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

}  // namespace
}  // namespace bess
