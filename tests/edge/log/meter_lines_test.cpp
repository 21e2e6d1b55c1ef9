// What the journal says of a meter that is not to be believed: each turn once.
#include "edge/log/journal_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/tokens.h"

namespace bess {
namespace {

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
