// Two rings read as one log: a short one in memory continues where the disk stopped.
#include "edge/records/log/log_reader.h"

#include <gmock/gmock.h>

#include <filesystem>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/edge/records/log/sample_records.h"

namespace bess {
namespace {

class Reader : public ::testing::Test {
 protected:
  Reader() {
    settings_.ring = folder_.file("state.ring").c_str();
    settings_.run_ring = folder_.file("run.ring").c_str();
  }
  /// A ring of that size with these record numbers in turn.
  void write(const FixedText<511>& path, std::int64_t capacity, std::uint64_t first,
             std::uint64_t last) {
    RingLog ring;
    ASSERT_TRUE(ring.open(path.c_str(), capacity, error_)) << error_.c_str();
    for (std::uint64_t n = first; n <= last; ++n) ASSERT_TRUE(ring.append(record(n), n));
  }
  static CycleRecord record(std::uint64_t number) {
    CycleRecord r;
    r.cycle = static_cast<std::int64_t>(number);
    return r;
  }
  void expect_numbers(std::uint64_t oldest, std::uint64_t newest) const {
    EXPECT_EQ(reader_.oldest_number(), oldest);
    EXPECT_EQ(reader_.newest_number(), newest);
    CycleRecord r;
    ASSERT_TRUE(reader_.newest(r));
    EXPECT_EQ(r.cycle, static_cast<std::int64_t>(newest));
  }
  [[nodiscard]] bool has(std::uint64_t number) const {
    CycleRecord r;
    return reader_.read(number, r) && r.cycle == static_cast<std::int64_t>(number);
  }

  const TemporaryFolder folder_;
  EventLogSettings settings_;
  LogReader reader_;
  FileMessage error_;
};

TEST_F(Reader, RecordsInMemoryFollowThoseOnDisk) {
  write(settings_.ring, 100, 1, 20);
  write(settings_.run_ring, 8, 18, 30);
  ASSERT_TRUE(reader_.open(settings_, error_)) << error_.c_str();
  expect_numbers(1, 30);
  EXPECT_TRUE(has(1));
  EXPECT_TRUE(has(20));
  EXPECT_FALSE(has(21)) << "neither has it any more";
  EXPECT_TRUE(has(23));
  EXPECT_FALSE(has(31));
}

TEST_F(Reader, ADiskThatIsAheadOfMemoryCounts) {
  write(settings_.ring, 100, 1, 30);
  write(settings_.run_ring, 8, 1, 3);
  ASSERT_TRUE(reader_.open(settings_, error_)) << error_.c_str();
  expect_numbers(1, 30);
}

TEST_F(Reader, EitherAloneIsALog) {
  write(settings_.run_ring, 8, 18, 30);
  ASSERT_TRUE(reader_.open(settings_, error_));
  EXPECT_THAT(error_.c_str(), Names(settings_.ring.c_str()));
  expect_numbers(23, 30);
  std::filesystem::remove(settings_.run_ring.c_str());
  write(settings_.ring, 100, 5, 9);
  LogReader disk;
  ASSERT_TRUE(disk.open(settings_, error_));
  EXPECT_EQ(disk.newest_number(), 9U);
  settings_.run_ring = "";
  LogReader without;
  ASSERT_TRUE(without.open(settings_, error_));
  EXPECT_EQ(without.oldest_number(), disk.oldest_number());
}

TEST_F(Reader, EmptyOnesHaveNoNewestRecord) {
  write(settings_.ring, 10, 1, 0);
  write(settings_.run_ring, 8, 1, 0);
  ASSERT_TRUE(reader_.open(settings_, error_));
  EXPECT_EQ(reader_.newest_number(), 0U);
  CycleRecord r;
  EXPECT_FALSE(reader_.newest(r));
}

TEST_F(Reader, NeitherIsALine) {
  EXPECT_FALSE(reader_.open(settings_, error_));
  EXPECT_THAT(error_.c_str(), Names(settings_.ring.c_str()));
}

}  // namespace
}  // namespace bess
