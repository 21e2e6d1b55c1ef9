// What the journal says of a meter that is not to be believed: each turn once.
#include "edge/log/meter_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace bess {
namespace {

using ::testing::StartsWith;

struct MeterJournal {
  CycleRecord record{.mode = Mode::kRunning};
  MeterLines lines;

  std::string trust(bool is_mismatch, Mode mode = Mode::kRunning) {
    record.mode = mode;
    record.site.trust = {.is_mismatch = is_mismatch, .pause_until_utc_s = 1'679'875'920};
    return said(&MeterLines::add_trust_line);
  }
  std::string house(bool is_implausible) {
    record.site.house_is_implausible = is_implausible;
    return said(&MeterLines::add_house_line);
  }
  std::string said(bool (MeterLines::*add)(const CycleRecord&, TextBuffer&)) {
    char text[320];
    TextBuffer line(text);
    const bool is_said = (lines.*add)(record, line);
    EXPECT_EQ(is_said, !line.view().empty());
    EXPECT_FALSE(line.was_cut());
    return std::string(line.view());
  }
};

TEST(MeterLines, AFindingAndItsEnd) {
  MeterJournal journal;
  EXPECT_EQ(journal.trust(false), "");
  EXPECT_THAT(journal.trust(true), StartsWith("meter: it does not step with the battery"));
  EXPECT_THAT(std::string(journal.trust(true)), "");
  EXPECT_EQ(journal.trust(false, Mode::kStopping), "");
  EXPECT_EQ(journal.trust(true), "");
  EXPECT_EQ(journal.trust(false), "meter: it steps with the battery again, and is believed");
}

TEST(MeterLines, AHouseThatCannotBe) {
  MeterJournal journal;
  journal.record.site.grid_power_w = -131;
  journal.record.measurement.power_w = 500;
  EXPECT_EQ(journal.house(false), "");
  EXPECT_THAT(
      journal.house(true),
      StartsWith("meter: grid -131 W less battery 500 W leaves the house a load below zero"));
  EXPECT_EQ(journal.house(true), "");
  EXPECT_EQ(journal.house(false), "meter: the house's load is plausible again");
}

}  // namespace
}  // namespace bess
