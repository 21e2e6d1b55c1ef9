// Decision log on disk: no complete record is lost and no torn record is accepted, whatever happens
// to the newest record and whenever the process dies.
#include "edge/records/log/ring_log.h"

#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <random>

#include "shared/crc32.h"
#include "shared/scaled_clock.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/edge/records/log/sample_records.h"

namespace bess {
namespace {

constexpr std::int64_t kHeaderBytes = 4'096;

RecordBytes bytes_of(const CycleRecord& record, std::uint64_t number) {
  RecordBytes bytes;
  encode_record(record, number, bytes);
  return bytes;
}

/// Writes the matching CRC at the end of the bytes.
void seal(RecordBytes& bytes) {
  Crc32 crc;
  crc.add_bytes(bytes.data(), kRecordBytes - 4);
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kRecordBytes - 4 + i] = static_cast<std::uint8_t>(crc.value() >> (8 * i));
  }
}

/// The ring of programs with records of 256 bytes: their header, and their part of each record.
std::string older_ring(std::int64_t capacity, std::int64_t records) {
  const auto put = [](std::string& out, std::uint64_t value, int bytes) {
    for (int i = 0; i < bytes; ++i) out += static_cast<char>(value >> (8 * i));
  };
  const auto crc = [](const std::string& bytes) {
    Crc32 sum;
    sum.add_bytes(bytes.data(), bytes.size());
    return sum.value();
  };
  std::string file = "BESSRING";
  put(file, 1, 4);
  put(file, kOlderRecordBytes, 4);
  put(file, static_cast<std::uint64_t>(capacity), 8);
  put(file, crc(file), 4);
  file.resize(static_cast<std::size_t>(kHeaderBytes));
  file.append(kOlderRecordBytes, '\0');  // number 0 never existed
  for (std::int64_t n = 1; n <= records; ++n) {
    const RecordBytes whole = bytes_of(full_record(n), static_cast<std::uint64_t>(n));
    std::string record(whole.begin(), whole.begin() + 204);  // up to context_class
    record.resize(kOlderRecordBytes - 4);
    put(record, crc(record), 4);
    file += record;
  }
  file.resize(static_cast<std::size_t>(kHeaderBytes) +
              static_cast<std::size_t>(capacity) * kOlderRecordBytes);
  return file;
}

using Cycles = std::vector<std::int64_t>;

class Ring : public ::testing::Test {
 protected:
  void append(std::int64_t capacity, std::int64_t first_cycle, std::int64_t count) {
    RingLog ring;
    ASSERT_TRUE(ring.open(path_.c_str(), capacity, error_)) << error_.c_str();
    for (std::int64_t i = 0; i < count; ++i) {
      ASSERT_TRUE(ring.append(full_record(first_cycle + i)));
    }
  }
  /// Opens it, which must succeed, with its newest record.
  CycleRecord newest_in(RingLog& ring, std::int64_t capacity) {
    CycleRecord newest;
    EXPECT_TRUE(ring.open(path_.c_str(), capacity, error_)) << error_.c_str();
    EXPECT_TRUE(ring.newest(newest));
    return newest;
  }
  /// Control cycles that a reader finds, in order.
  Cycles cycles() {
    RingLog ring;
    Cycles found;
    EXPECT_TRUE(ring.open_to_read(path_.c_str(), error_)) << error_.c_str();
    CycleRecord record;
    for (std::uint64_t n = ring.oldest_number(); n <= ring.newest_number(); ++n) {
      if (ring.read(n, record)) found.push_back(record.cycle);
    }
    return found;
  }

  /// In memory if possible: the tests wait for the disk thousands of times.
  const TemporaryFolder folder_{std::filesystem::exists("/dev/shm")
                                    ? std::filesystem::path("/dev/shm")
                                    : std::filesystem::temp_directory_path()};
  const std::string path_ = folder_.file("decisions.ring");
  FileMessage error_;
};

TEST(RecordCodec, ZerosAndUnknownCodesAreNoRecord) {
  CycleRecord record;
  std::uint64_t number = 0;
  EXPECT_FALSE(decode_record(RecordBytes{}, record, number));
  RecordBytes bytes = bytes_of(full_record(7), 42);
  bytes[24] = kModeCount;  // a mode of a later version, with a valid CRC
  seal(bytes);
  EXPECT_FALSE(decode_record(bytes, record, number));
}

TEST_F(Ring, NewestSurvivesReopeningAndTheRingWraps) {
  append(5, 1, 3);
  RingLog ring;
  const CycleRecord newest = newest_in(ring, 5);
  EXPECT_EQ(newest.cycle, 3);
  EXPECT_EQ(newest.counters.flash_writes_today, 25);
  append(5, 4, 9);
  EXPECT_EQ(cycles(), (Cycles{8, 9, 10, 11, 12}));
  EXPECT_EQ(std::filesystem::file_size(path_), kHeaderBytes + 5 * kRecordBytes);
}

TEST_F(Ring, OneOfAnOlderProgramIsReadAndContinuedInANewFile) {
  folder_.write("decisions.ring", older_ring(5, 3));
  EXPECT_EQ(cycles(), (Cycles{1, 2, 3}));
  RingLog ring;
  const CycleRecord newest = newest_in(ring, 5);
  EXPECT_EQ(newest.cycle, 3);
  EXPECT_EQ(newest.context_class, 12);
  EXPECT_FALSE(newest.is_tripped);
  ASSERT_TRUE(ring.append(full_record(4)));
  EXPECT_EQ(cycles(), (Cycles{3, 4}));
  EXPECT_EQ(text_of_file(path_ + ".old"), older_ring(5, 3));
}

/// Half of the new record, half of the old one, at every length: the result of an interrupted
/// write.
TEST_F(Ring, ARecordTornInTheMiddleIsSkipped) {
  append(3, 1, 3);
  const std::string before = text_of_file(path_);
  append(3, 4, 1);  // number 4 overwrites number 1 in slot 1
  const std::string after = text_of_file(path_);
  const std::size_t begin = kHeaderBytes + kRecordBytes;
  for (std::size_t length = 1; length < kRecordBytes; ++length) {
    std::string torn = before;
    torn.replace(begin, length, after, begin, length);
    if (torn == before || torn == after) continue;
    folder_.write("decisions.ring", torn);
    ASSERT_EQ(cycles(), (Cycles{2, 3})) << length << " bytes written";
  }
}

TEST_F(Ring, AFileCutAtEveryByteOfItsLastRecordStillOpens) {
  append(3, 1, 2);  // slots 1 and 2: the newest is last in the file
  const std::string whole = text_of_file(path_);
  for (std::size_t missing = 1; missing <= kRecordBytes; ++missing) {
    folder_.write("decisions.ring", whole.substr(0, whole.size() - missing));
    ASSERT_EQ(cycles(), (Cycles{1})) << missing << " bytes missing";
    append(3, 3, 1);
    ASSERT_EQ(cycles(), (Cycles{1, 3})) << missing << " bytes missing";
  }
}

TEST_F(Ring, AnotherCapacitySetsTheFileAsideAndTakesOver) {
  append(5, 1, 4);
  RingLog larger;
  EXPECT_EQ(newest_in(larger, 9).cycle, 4);
  ASSERT_TRUE(larger.append(full_record(5)));
  EXPECT_EQ(larger.newest_number(), 5U);
  EXPECT_TRUE(std::filesystem::exists(path_ + ".old"));
  EXPECT_FALSE(larger.damage().is_any());
}

/// The process that made the larger log died before writing to it.
TEST_F(Ring, TheNewestIsInTheNewFileFromItsBeginning) {
  append(5, 1, 4);
  append(9, 5, 0);
  RingLog ring;
  EXPECT_EQ(newest_in(ring, 9).cycle, 4);
}

TEST_F(Ring, AFileThatIsNoLogIsSetAsideAndReported) {
  folder_.write("decisions.ring", std::string(kHeaderBytes + 5 * kRecordBytes, 'x'));
  RingLog reader;
  EXPECT_FALSE(reader.open_to_read(path_.c_str(), error_));
  EXPECT_THAT(error_.c_str(), Names(path_));
  RingLog fresh;
  CycleRecord newest;
  ASSERT_TRUE(fresh.open(path_.c_str(), 5, error_)) << error_.c_str();
  EXPECT_FALSE(fresh.newest(newest));
  EXPECT_TRUE(fresh.damage().is_set_aside);
  EXPECT_TRUE(std::filesystem::exists(path_ + ".old"));
}

/// Numbers are skipped where a disk refused records; older contents of their places do not count.
TEST_F(Ring, NumbersMayBeLeftOut) {
  append(5, 1, 4);
  RingLog ring;
  ASSERT_TRUE(ring.open(path_.c_str(), 5, error_)) << error_.c_str();
  ASSERT_TRUE(ring.append(full_record(7), 7));
  EXPECT_EQ(ring.newest_number(), 7U);
  EXPECT_EQ(cycles(), (Cycles{3, 4, 7}));
  EXPECT_FALSE(ring.damage().is_any());
}

/// Losses found on opening, as in the journal; empty = none.
std::string damage_line(const std::string& path, std::int64_t capacity) {
  RingLog ring;
  FileMessage error;
  EXPECT_TRUE(ring.open(path.c_str(), capacity, error)) << error.c_str();
  if (!ring.damage().is_any()) return "";
  char text[512];
  TextBuffer line(text);
  describe_damage(ring.damage(), "decisions.ring", line);
  return std::string(line.view());
}

std::string flipped(std::string bytes, std::size_t at, unsigned char mask) {
  bytes[at] = static_cast<char>(static_cast<unsigned char>(bytes[at]) ^ mask);
  return bytes;
}

TEST_F(Ring, EveryBrokenByteOfTheHeaderCostsNothingAndIsRepaired) {
  append(5, 1, 7);
  const std::string whole = text_of_file(path_);
  for (const std::size_t begin : {std::size_t{0}, std::size_t{2'048}}) {
    for (std::size_t i = begin; i < begin + 28; ++i) {
      folder_.write("decisions.ring", flipped(whole, i, 0x10));
      ASSERT_EQ(cycles(), (Cycles{3, 4, 5, 6, 7})) << "byte " << i;
      ASSERT_EQ(has_code(damage_line(path_, 5), "decisions.ring"), begin == 0) << "byte " << i;
      ASSERT_EQ(text_of_file(path_), whole) << "byte " << i;
    }
  }
}

TEST_F(Ring, WithoutAHeaderTheRecordsShowTheirLayout) {
  append(5, 1, 7);
  std::string headless = text_of_file(path_);
  headless.replace(0, kHeaderBytes, kHeaderBytes, '\xff');
  for (const std::int64_t configured : {std::int64_t{5}, std::int64_t{9}}) {
    folder_.write("decisions.ring", headless);
    ASSERT_EQ(cycles(), (Cycles{3, 4, 5, 6, 7}));
    EXPECT_THAT(damage_line(path_, configured), Names("decisions.ring"));
  }
  RingLog ring;
  EXPECT_EQ(newest_in(ring, 9).cycle, 7);
}

TEST_F(Ring, WithoutHeaderAndEndTheConfiguredSizeIsTried) {
  append(9, 1, 16);  // wrapped: the newest in slot 7
  std::string cut = text_of_file(path_);
  cut.replace(0, kHeaderBytes, kHeaderBytes, '\0');
  cut.resize(cut.size() - kRecordBytes);
  folder_.write("decisions.ring", cut);
  EXPECT_THAT(damage_line(path_, 9), Names("decisions.ring 1"));
  EXPECT_EQ(cycles(), (Cycles{9, 10, 11, 12, 13, 14, 15, 16}));
  EXPECT_EQ(std::filesystem::file_size(path_), kHeaderBytes + 9 * kRecordBytes);
}

/// One flipped byte anywhere, at places and with masks of a named seed: at most one record is lost,
/// the loss is reported, and the rest is as written.
TEST_F(Ring, OneFlippedByteAnywhereCostsAtMostOneRecordAndIsReported) {
  constexpr std::int64_t kCapacity = 40;
  std::mt19937 random(20261123);
  for (const std::int64_t written : {std::int64_t{12}, std::int64_t{40}, std::int64_t{97}}) {
    std::filesystem::remove(path_);
    append(kCapacity, 1, written);
    const std::string whole = text_of_file(path_);
    const Cycles before = cycles();
    for (int draw = 0; draw < 1'500; ++draw) {
      const std::size_t at = random() % whole.size();
      const auto mask = static_cast<unsigned char>(1 + random() % 255);
      folder_.write("decisions.ring", flipped(whole, at, mask));
      const std::string line = damage_line(path_, kCapacity);
      const Cycles after = cycles();
      ASSERT_TRUE(std::includes(before.begin(), before.end(), after.begin(), after.end()));
      ASSERT_GE(after.size() + 1, before.size()) << "byte " << at;
      const bool is_lost = after.size() < before.size();
      ASSERT_TRUE(!is_lost || has_code(line, "1")) << at << line;
    }
  }
}

TEST_F(Ring, WhatCannotBeOpenedIsOneLine) {
  RingLog ring;
  EXPECT_FALSE(ring.open("/nonexistent/decisions.ring", 5, error_));
  EXPECT_THAT(error_.c_str(), Names("/nonexistent/decisions.ring"));
  RingLog reader;
  EXPECT_FALSE(reader.open_to_read(folder_.file("none").c_str(), error_));
  EXPECT_THAT(error_.c_str(), Names(folder_.file("none")));
}

/// Appends until it is killed; writes to `reported` when it has begun.
[[noreturn]] void append_for_ever(const char* path, int reported) {
  RingLog ring;
  FileMessage error;
  if (!ring.open(path, 16, error)) _exit(1);
  while (ring.append(full_record(static_cast<std::int64_t>(ring.newest_number()) + 1))) {
    if (reported >= 0 && write(reported, "x", 1) != 1) _exit(3);
    reported = -1;
  }
  _exit(2);
}

/// A writer that is killed at random instants: the next one continues without a gap or a
/// repetition. Every third is killed at any instant since its start, the others while they append.
TEST_F(Ring, SurvivesKillsAtRandomInstants) {
  std::mt19937 random(20261121);
  std::uint64_t newest_before = 0;
  for (int round = 0; round < 30; ++round) {
    const bool while_appending = round % 3 != 2;
    int ends[2];
    ASSERT_EQ(pipe(ends), 0);
    const pid_t child = fork();
    if (child == 0) append_for_ever(path_.c_str(), ends[1]);
    close(ends[1]);
    char reported = 0;
    if (while_appending) {
      ASSERT_EQ(read(ends[0], &reported, 1), 1) << "round " << round;
    }
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + random() % 5'000'000);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    close(ends[0]);
    ASSERT_TRUE(WIFSIGNALED(status)) << "round " << round;
    const Cycles found = cycles();
    for (std::size_t i = 1; i < found.size(); ++i) ASSERT_EQ(found[i], found[i - 1] + 1);
    ASSERT_FALSE(found.empty());
    const auto newest = static_cast<std::uint64_t>(found.back());
    ASSERT_GE(newest, newest_before + (while_appending ? 1 : 0));
    newest_before = newest;
    ASSERT_GE(found.size(), std::min<std::uint64_t>(newest_before, 15));
  }
  EXPECT_GT(newest_before, 16U) << "the ring has not wrapped";
}

}  // namespace
}  // namespace bess
