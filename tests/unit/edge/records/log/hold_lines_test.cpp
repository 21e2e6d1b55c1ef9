// Journal lines of a hold, and of a meter in doubt: each change once.
#include "edge/records/log/event_log.h"

#include <gmock/gmock.h>

#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::Not;

constexpr std::int64_t kTickUtcS = 1'679'875'320;  // 2023-03-27T00:02:00Z
constexpr HoldReport kHeld{.held = true, .power_w = -2'000, .until_utc_s = kTickUtcS + 240};
constexpr HoldReport kUnreadable{.unreadable = true};

struct Journal {
  /// Empty: no line.
  std::string after(int cycle, const HoldReport& hold, bool is_in_control = true) {
    CycleRecord record{.utc_s = kTickUtcS + 120 * cycle, .mode = mode};
    record.hold = hold;
    char text[256];
    TextBuffer line(text);
    RunIdentity identity;
    identity.control = is_in_control;
    const bool said = lines.add_hold_line(record, identity, line);
    EXPECT_EQ(said, !line.view().empty());
    EXPECT_FALSE(line.was_cut());
    return std::string(line.view());
  }

  ChangeLines lines;
  Mode mode = Mode::kRunning;
};

TEST(HoldLines, ABeginningAndAnEnd) {
  Journal journal;
  EXPECT_EQ(journal.after(-1, {}), "");
  EXPECT_THAT(journal.after(0, kHeld), Names("hold -2000 W 2023-03-27T00:06:00Z"));
  EXPECT_EQ(journal.after(1, kHeld), "");
  EXPECT_THAT(journal.after(2, {}), AllOf(Names("hold"), Not(Names("W"))));
  EXPECT_EQ(journal.after(3, {}), "");
}

TEST(HoldLines, AChangeAndARelease) {
  Journal journal;
  EXPECT_NE(journal.after(0, kHeld), "");
  HoldReport other = kHeld;
  other.power_w = 0;
  EXPECT_THAT(journal.after(1, other, false), Names("hold 0 W 2023-03-27T00:06:00Z"));
  EXPECT_THAT(journal.after(1, {}), AllOf(Names("hold"), Not(Names("W"))));
}

TEST(HoldLines, AnUnreadableFileOnce) {
  Journal journal;
  EXPECT_NE(journal.after(0, kUnreadable), "");
  EXPECT_EQ(journal.after(1, kUnreadable), "");
  EXPECT_THAT(journal.after(2, {}), Names("hold"));
}

TEST(HoldLines, TheEndOfTheProcessIsNotTheEndOfTheHold) {
  Journal journal;
  EXPECT_NE(journal.after(0, kHeld), "");
  journal.mode = Mode::kStopping;
  EXPECT_EQ(journal.after(1, {}), "");
}

struct MeterJournal {
  CycleRecord record{.mode = Mode::kRunning};
  ChangeLines lines;

  std::string trust(bool is_mismatch, Mode mode = Mode::kRunning) {
    record.mode = mode;
    record.site.trust = {.is_mismatch = is_mismatch, .pause_until_utc_s = 1'679'875'920};
    return said(&ChangeLines::add_trust_line);
  }
  std::string house(bool is_implausible) {
    record.site.house_is_implausible = is_implausible;
    return said(&ChangeLines::add_house_line);
  }
  std::string said(bool (ChangeLines::*add)(const CycleRecord&, const RunIdentity&, TextBuffer&)) {
    char text[320];
    TextBuffer line(text);
    const bool is_said = (lines.*add)(record, RunIdentity{}, line);
    EXPECT_EQ(is_said, !line.view().empty());
    EXPECT_FALSE(line.was_cut());
    return std::string(line.view());
  }
};

TEST(MeterLines, AFindingAndItsEnd) {
  MeterJournal journal;
  EXPECT_EQ(journal.trust(false), "");
  EXPECT_THAT(journal.trust(true), Names("meter"));
  EXPECT_THAT(std::string(journal.trust(true)), "");
  EXPECT_EQ(journal.trust(false, Mode::kStopping), "");
  EXPECT_EQ(journal.trust(true), "");
  EXPECT_THAT(journal.trust(false), Names("meter"));
}

TEST(MeterLines, AHouseThatCannotBe) {
  MeterJournal journal;
  journal.record.site.grid_power_w = -131;
  journal.record.measurement.power_w = 500;
  EXPECT_EQ(journal.house(false), "");
  EXPECT_THAT(journal.house(true), Names("meter -131 W 500"));
  EXPECT_EQ(journal.house(true), "");
  EXPECT_THAT(journal.house(false), Names("meter"));
}

}  // namespace
}  // namespace bess
