// One way's outbox: order, rounds, what is given up and said so, and that nobody waits for it.
#include "edge/notify/outbox.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <atomic>

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr std::int64_t kNow = 1'679'875'320;  // 2023-03-27T00:02:00Z

Message alarm(const std::string& text, std::int64_t utc_s = kNow) {
  return {.kind = MessageKind::kAlarm, .key = text, .text = text, .utc_s = utc_s};
}

/// A way that notes what it is given, and takes it or not as it is told to.
class Recorder {
 public:
  Channel way() {
    return [this](const Message& message, const std::stop_token& stop) {
      std::unique_lock lock(mutex_);
      tried_.push_back(message.text);
      begun_.notify_all();
      changed_.wait(lock, stop, [this] { return !is_stuck_; });
      if (is_stuck_) return std::string("cut");
      if (is_refusing_) return std::string("refused");
      taken_.push_back(message.text);
      return std::string();
    };
  }
  void refuse(bool refuse) { set(is_refusing_, refuse); }
  void get_stuck(bool stuck) { set(is_stuck_, stuck); }
  std::vector<std::string> tried() { return copy(tried_); }
  std::vector<std::string> taken() { return copy(taken_); }
  void await_tries(std::size_t count) {
    std::unique_lock lock(mutex_);
    begun_.wait(lock, [&] { return tried_.size() >= count; });
  }

 private:
  void set(bool& flag, bool value) {
    const std::lock_guard lock(mutex_);
    flag = value;
    changed_.notify_all();
  }
  std::vector<std::string> copy(const std::vector<std::string>& list) {
    const std::lock_guard lock(mutex_);
    return list;
  }

  std::mutex mutex_;
  std::condition_variable_any changed_;
  std::condition_variable begun_;
  bool is_refusing_ = false;
  bool is_stuck_ = false;
  std::vector<std::string> tried_;
  std::vector<std::string> taken_;
};

class OutboxTest : public ::testing::Test {
 protected:
  std::unique_ptr<Outbox> outbox_with(Owed owed = {}) {
    return std::make_unique<Outbox>("command", way_.way(), std::move(owed), bell_);
  }
  static void run_round(Outbox& outbox, std::int64_t now_utc_s = kNow) {
    outbox.begin_round(now_utc_s);
    EXPECT_TRUE(outbox.wait_until_done(std::chrono::minutes(1)));
  }

  Bell bell_;
  Recorder way_;
};

TEST_F(OutboxTest, SendsInOrderOnceARoundBegins) {
  const auto outbox = outbox_with({.messages = {alarm("a")}});
  outbox->add(alarm("b"));
  outbox->add(alarm("c"));
  EXPECT_EQ(outbox->owed().messages.size(), 3U);
  EXPECT_THAT(way_.tried(), IsEmpty());  // kept in a file before it is sent
  run_round(*outbox);
  EXPECT_THAT(way_.taken(), ElementsAre("a", "b", "c"));
  EXPECT_TRUE(outbox->owed().messages.empty());
}

TEST_F(OutboxTest, WhatIsNotTakenIsTriedAgainEveryRoundAndTheRestWaitsBehindIt) {
  const auto outbox = outbox_with({.messages = {alarm("a"), alarm("b")}});
  way_.refuse(true);
  run_round(*outbox);
  run_round(*outbox);
  EXPECT_THAT(way_.tried(), ElementsAre("a", "a"));
  EXPECT_EQ(outbox->owed().messages.size(), 2U);
  way_.refuse(false);
  run_round(*outbox);
  EXPECT_THAT(way_.taken(), ElementsAre("a", "b"));
}

TEST_F(OutboxTest, AStuckWayHoldsUpNeitherAnotherOneNorWhoAsks) {
  Recorder quick;
  Outbox other("mqtt", quick.way(), {}, bell_);
  const auto outbox = outbox_with({.messages = {alarm("a")}});
  way_.get_stuck(true);
  outbox->begin_round(kNow);
  way_.await_tries(1);
  for (int i = 0; i < 100; ++i) {
    const Message message = alarm(std::to_string(i));
    outbox->add(message);
    other.add(message);
    outbox->begin_round(kNow + i);
    run_round(other, kNow + i);
  }
  EXPECT_EQ(quick.taken().size(), 100U);
  EXPECT_EQ(outbox->owed().messages.size(), 101U);
  way_.get_stuck(false);
  run_round(*outbox);
  EXPECT_EQ(way_.taken().size(), 101U);
}

/// The queue ends at 200: the oldest go, and the way is told how many before anything else.
TEST_F(OutboxTest, WhatDoesNotFitIsCountedAndTold) {
  const auto outbox = outbox_with();
  for (int i = 0; i < 205; ++i) outbox->add(alarm("m" + std::to_string(i), kNow + 60 * i));
  EXPECT_EQ(outbox->owed().messages.size(), Outbox::kMessagesMax);
  EXPECT_EQ(outbox->owed().dropped.count, 5);
  run_round(*outbox);
  const std::vector<std::string> taken = way_.taken();
  ASSERT_EQ(taken.size(), Outbox::kMessagesMax + 1);
  EXPECT_EQ(taken[0],
            "5 messages of 2023-03-27T00:02:00Z to 2023-03-27T00:06:00Z dropped: command took "
            "none for too long; the journal of bess-notify has them");
  EXPECT_EQ(taken[1], "m5");
  EXPECT_EQ(taken.back(), "m204");
  EXPECT_EQ(outbox->owed().dropped.count, 0);
}

/// Full while the oldest is on its way: that one is not lost, and none is told twice.
TEST_F(OutboxTest, WhatIsOnItsWayIsNotGivenUp) {
  const auto outbox = outbox_with({.messages = {alarm("first")}});
  way_.get_stuck(true);
  outbox->begin_round(kNow);
  way_.await_tries(1);
  for (int i = 0; i < 201; ++i) outbox->add(alarm("m" + std::to_string(i)));
  EXPECT_EQ(outbox->owed().messages.front().text, "first");
  way_.get_stuck(false);
  run_round(*outbox);
  const std::vector<std::string> taken = way_.taken();
  ASSERT_EQ(taken.size(), 201U);
  EXPECT_EQ(taken[0], "first");
  EXPECT_THAT(taken[1],
              HasSubstr("2 messages of 2023-03-27T00:02:00Z to 2023-03-27T00:02:00Z dropped"));
  EXPECT_EQ(taken[2], "m2");
}

/// More is dropped while the count is on its way: the next count has the rest.
TEST_F(OutboxTest, NoDroppedMessageIsForgottenOrCountedTwice) {
  const auto outbox =
      outbox_with({.dropped = {.count = 3, .first_utc_s = kNow, .last_utc_s = kNow}});
  way_.get_stuck(true);
  outbox->begin_round(kNow);
  way_.await_tries(1);
  for (int i = 0; i < 204; ++i) outbox->add(alarm("m" + std::to_string(i)));
  way_.get_stuck(false);
  run_round(*outbox);
  const std::vector<std::string> taken = way_.taken();
  EXPECT_THAT(taken[0], HasSubstr("3 messages"));
  EXPECT_THAT(taken[1], HasSubstr("4 messages"));
  EXPECT_EQ(taken[2], "m4");
}

TEST_F(OutboxTest, AfterThreeDaysAMessageIsGivenUpAndCounted) {
  const auto outbox = outbox_with({.messages = {alarm("old", kNow - Outbox::kPatienceS - 1),
                                                alarm("young", kNow - Outbox::kPatienceS)}});
  run_round(*outbox);
  ASSERT_EQ(way_.taken().size(), 2U);
  EXPECT_THAT(way_.taken()[0], HasSubstr("1 message of 2023-03-24T00:01:59Z dropped"));
  EXPECT_EQ(way_.taken()[1], "young");
}

TEST_F(OutboxTest, TheEndCutsWhatIsStuckAndItStaysOwed) {
  const auto outbox = outbox_with({.messages = {alarm("a"), alarm("b")}});
  way_.get_stuck(true);
  outbox->begin_round(kNow);
  way_.await_tries(1);
  outbox->stop();
  EXPECT_EQ(outbox->owed().messages.size(), 2U);
  EXPECT_THAT(way_.tried(), ElementsAre("a"));
}

TEST_F(OutboxTest, TheBellRingsForEachThatWasTaken) {
  const auto outbox = outbox_with({.messages = {alarm("a")}});
  const auto rings = [this] {
    std::uint64_t count = 0;
    return read(bell_.fd(), &count, sizeof count) == sizeof count;
  };
  EXPECT_FALSE(rings());
  run_round(*outbox);
  EXPECT_TRUE(rings());
  run_round(*outbox);
  EXPECT_FALSE(rings());
}

}  // namespace
}  // namespace bess
