// File of cleared trips: its text, invalid texts, and that an entry in either copy suffices.
#include "edge/app/storage/restored_state.h"

#include <gtest/gtest.h>

#include <cerrno>
#include <filesystem>

#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

constexpr std::int64_t kTrip = 1'679'788'800;

std::string text_of(const ClearedTrips& cleared) {
  return std::string(format_cleared(cleared).view());
}

ClearedTrips cleared(int count) {
  ClearedTrips trips;
  for (int i = 0; i < count; ++i) trips.add(kTrip + i);
  return trips;
}

TEST(ClearedTrips, AreOneLineThatReadsBack) {
  EXPECT_EQ(text_of(cleared(2)).substr(0, 37), "bess-cleared 1 1679788801 1679788800 ");
  for (int count = 0; count <= 8; ++count) {
    const ClearedTrips back = parse_cleared(text_of(cleared(count)));
    EXPECT_FALSE(back.unreadable);
    EXPECT_EQ(back.utc_s, cleared(count).utc_s);
  }
}

TEST(ClearedTrips, TheOldestOfNineIsForgotten) {
  const ClearedTrips nine = cleared(9);
  EXPECT_FALSE(nine.has(kTrip));
  EXPECT_TRUE(nine.has(kTrip + 1));
  EXPECT_TRUE(nine.has(kTrip + 8));
  EXPECT_FALSE(ClearedTrips{}.has(0)) << "no trip does not count as cleared";
}

/// A damaged card must not clear a trip.
TEST(ClearedTrips, AnythingElseIsUnreadable) {
  const std::string good = text_of(cleared(2));
  for (std::size_t i = 0; i < good.size(); ++i) {
    for (int bit = 0; bit < 8; ++bit) {
      std::string bad = good;
      bad[i] = static_cast<char>(bad[i] ^ (1 << bit));
      EXPECT_TRUE(parse_cleared(bad).unreadable) << bad;
    }
    EXPECT_TRUE(parse_cleared(good.substr(0, i)).unreadable) << i;
  }
  for (const std::string& bad : {good + "\n", good + good, std::string(good.size(), '\0'),
                                 std::string("bess-cleared 2") + good.substr(14)}) {
    EXPECT_TRUE(parse_cleared(bad).unreadable) << bad;
  }
}

TEST(ClearedTrips, AnOlderProgramsInstantCounts) {
  EXPECT_TRUE(parse_cleared("1679788800\n").has(kTrip));
  for (const char* cut : {"1679788800", "16797888x0\n", "\n", ""}) {
    EXPECT_TRUE(parse_cleared(cut).unreadable) << cut;
  }
}

class TwoPlaces : public ::testing::Test {
 protected:
  TwoPlaces() {
    paths_.state = folder_.file("state").c_str();
    paths_.run = folder_.file("run").c_str();
  }
  const TemporaryFolder folder_;
  StateFilePaths paths_;
};

TEST_F(TwoPlaces, AnEntryInEitherIsEnough) {
  EXPECT_FALSE(is_trip_cleared(paths_, kTrip));
  for (const FixedText<639>* path : {&paths_.state, &paths_.run}) {
    ASSERT_TRUE(clear_trip_of(path->c_str(), kTrip));
    EXPECT_TRUE(is_trip_cleared(paths_, kTrip));
    EXPECT_FALSE(is_trip_cleared(paths_, kTrip + 1));
    std::filesystem::remove(path->c_str());
    EXPECT_FALSE(is_trip_cleared(paths_, kTrip));
  }
}

TEST_F(TwoPlaces, AnUnreadableFileIsNoEntryAndIsRewritten) {
  folder_.write("state", "nonsense");
  EXPECT_TRUE(read_cleared(paths_.state.c_str()).unreadable);
  EXPECT_FALSE(is_trip_cleared(paths_, kTrip));
  ASSERT_TRUE(clear_trip_of(paths_.state.c_str(), kTrip));
  EXPECT_TRUE(is_trip_cleared(paths_, kTrip));

  std::filesystem::create_directory(paths_.run.c_str());
  EXPECT_TRUE(read_cleared(paths_.run.c_str()).unreadable);
  EXPECT_FALSE(clear_trip_of(paths_.run.c_str(), kTrip));
  EXPECT_EQ(errno, EISDIR);
  EXPECT_TRUE(is_trip_cleared(paths_, kTrip)) << "the other copy has it";
}

TEST_F(TwoPlaces, NoPathIsNothingCleared) {
  EXPECT_FALSE(read_cleared("").unreadable);
  EXPECT_FALSE(is_trip_cleared({}, kTrip));
  ASSERT_TRUE(clear_trip_of(paths_.state.c_str(), kTrip));
  ASSERT_TRUE(clear_trip_of(paths_.state.c_str(), kTrip + 1)) << "in addition to the one before";
  EXPECT_TRUE(is_trip_cleared(paths_, kTrip));
}

}  // namespace
}  // namespace bess
