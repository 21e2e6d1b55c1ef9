// The decision log on disk: nothing that was written whole is lost, nothing torn is believed,
// whatever happens to the newest record and whenever the process dies.
#include "edge/log/ring_log.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "shared/crc32.h"
#include "shared/scaled_clock.h"
#include "tests/edge/log/sample_records.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

constexpr std::int64_t kHeaderBytes = 4'096;

RecordBytes bytes_of(const CycleRecord& record, std::uint64_t number) {
  RecordBytes bytes;
  encode_record(record, number, bytes);
  return bytes;
}

/// Puts the CRC that the bytes now need at their end.
void seal(RecordBytes& bytes) {
  Crc32 crc;
  crc.add_bytes(bytes.data(), kRecordBytes - 4);
  for (std::size_t i = 0; i < 4; ++i) {
    bytes[kRecordBytes - 4 + i] = static_cast<std::uint8_t>(crc.value() >> (8 * i));
  }
}

/// The ring as programs with records of 256 bytes wrote it: their header, and their part of each
/// record.
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

void write_file(const std::string& path, const std::string& bytes) {
  std::ofstream(path, std::ios::binary | std::ios::trunc) << bytes;
}

class Ring : public ::testing::Test {
 protected:
  void append(std::int64_t capacity, std::int64_t first_cycle, std::int64_t count) {
    RingLog ring;
    ASSERT_TRUE(ring.open(path_.c_str(), capacity, error_)) << error_.c_str();
    for (std::int64_t i = 0; i < count; ++i) {
      ASSERT_TRUE(ring.append(full_record(first_cycle + i)));
    }
  }
  /// Cycles that a reader finds, in order.
  std::vector<std::int64_t> cycles() {
    RingLog ring;
    std::vector<std::int64_t> found;
    EXPECT_TRUE(ring.open_to_read(path_.c_str(), error_)) << error_.c_str();
    CycleRecord record;
    for (std::uint64_t n = ring.oldest_number(); n <= ring.newest_number(); ++n) {
      if (ring.read(n, record)) found.push_back(record.cycle);
    }
    return found;
  }

  /// In memory where there is one: the tests wait for the disk thousands of times.
  const TemporaryFolder folder_{std::filesystem::exists("/dev/shm")
                                    ? std::filesystem::path("/dev/shm")
                                    : std::filesystem::temp_directory_path()};
  const std::string path_ = folder_.file("decisions.ring");
  FileMessage error_;
};

TEST(RecordCodec, KeepsEveryField) {
  const RecordBytes bytes = bytes_of(full_record(7), 42);
  CycleRecord back;
  std::uint64_t number = 0;
  ASSERT_TRUE(decode_record(bytes, back, number));
  EXPECT_EQ(number, 42U);
  EXPECT_EQ(back.cycle, 7);
  EXPECT_EQ(back.mode, Mode::kHolding);
  EXPECT_EQ(back.measurement.order_power_w, -8);
  EXPECT_EQ(back.price.status, Status::kTlsRefused);
  EXPECT_EQ(back.reason, Reason::kPriceQuarterHour);
  EXPECT_EQ(back.counters.flash_writes_today, 25);
  EXPECT_EQ(bytes_of(back, 42), bytes);  // what was read writes the same bytes: no field is lost
  EXPECT_NE(bytes_of(CycleRecord{}, 42), bytes);
}

TEST(RecordCodec, LayoutOnDiskIsFixed) {
  // What an older program wrote must stay readable: these places may never change.
  const RecordBytes bytes = bytes_of(full_record(7), 0x0102030405060708);
  EXPECT_EQ(bytes[0], 8);
  EXPECT_EQ(bytes[7], 1);
  EXPECT_EQ(bytes[16], 7);      // cycle
  EXPECT_EQ(bytes[24], 2);      // mode: holding
  EXPECT_EQ(bytes[26], 1);      // soc_e4
  EXPECT_EQ(bytes[30], 0xFE);   // power_w = -2
  EXPECT_EQ(bytes[118], 19);    // counters begin
  EXPECT_EQ(bytes[166], 25);    // flash_writes_today
  EXPECT_EQ(bytes[170], 26);    // deadline_misses
  EXPECT_EQ(bytes[182], 29);    // soc_moved_e4
  EXPECT_EQ(bytes[186], 0xE2);  // price_level.centi_q16 = -30
  EXPECT_EQ(bytes[194], 31);    // price_level.row_minute_utc_s
  EXPECT_EQ(bytes[202], 12);    // context_class
  EXPECT_EQ(bytes[204], 1);     // order_replaced
  EXPECT_EQ(bytes[205], 1);     // is_tripped
  EXPECT_EQ(bytes[206], 20);    // trip: soc_mismatch
  EXPECT_EQ(bytes[207], 0x20);  // its instant
  EXPECT_EQ(bytes[215], 33);    // weak_answers
  EXPECT_EQ(bytes[219], 34);    // replaced_orders
  EXPECT_EQ(bytes[223], 1);     // price.step_held
  EXPECT_EQ(bytes[224], 0xE0);  // price.held_centi_eur_per_mwh = -32
  EXPECT_EQ(bytes[228], 33);    // reversals.steps
  EXPECT_EQ(bytes[232], 0xFF);  // reversals.direction = -1
  EXPECT_EQ(bytes[234], 34);    // reversals.in_hour
  EXPECT_EQ(bytes[236], 1);     // hold.held
  EXPECT_EQ(bytes[237], 1);     // hold.unreadable
  EXPECT_EQ(bytes[238], 0xDD);  // hold.power_w = -35
  EXPECT_EQ(bytes[242], 36);    // hold.until_utc_s
  EXPECT_EQ(bytes[246], 37);    // reserve_soc_e4
  EXPECT_EQ(bytes[248], 38);    // days_since_full
  EXPECT_EQ(bytes[250], 1);     // site.has_grid_power
  EXPECT_EQ(bytes[251], 0xD9);  // site.grid_power_w = -39
  EXPECT_EQ(bytes[263], 42);    // site.order_cuts
  EXPECT_EQ(bytes[268], 14);    // site.limit_status: malformed
  EXPECT_EQ(bytes[269], 1);     // measurement.warning
  EXPECT_EQ(bytes[270], 1);     // measurement.order_ended
  EXPECT_EQ(bytes[271], 43);    // ended_orders
  EXPECT_EQ(bytes[275], 44);    // lost_orders.orders
  EXPECT_EQ(bytes[279], 45);    // lost_orders.judged
  EXPECT_EQ(bytes[281], 46);    // lost_orders.lost
  EXPECT_EQ(bytes[283], 47);    // standing_price.minute_utc_s
  EXPECT_EQ(bytes[291], 0xD0);  // standing_price.centi_eur_per_mwh = -48
  EXPECT_EQ(bytes[295], 49);    // standing_price.unchanged_s
  EXPECT_EQ(bytes[299], 1);     // price_frozen
  EXPECT_EQ(bytes[300], 50);    // findings.energy_share_percent
  EXPECT_EQ(bytes[302], 0xCD);  // findings.rest_loss_w = -51
  EXPECT_EQ(bytes[306], 52);    // findings.ramp_w_per_s
  EXPECT_EQ(bytes[310], 1);     // followed.is_judged
  EXPECT_EQ(bytes[311], 0xCB);  // followed.power_w = -53
  EXPECT_EQ(bytes[315], 54);    // followed.age_s
  EXPECT_EQ(bytes[319], 55);    // followed.soc_floor_e4
  EXPECT_EQ(bytes[321], 1);     // site.trust.is_mismatch
  EXPECT_EQ(bytes[322], 49);    // site.trust.doubt
  EXPECT_EQ(bytes[326], 50);    // site.trust.pause_until_utc_s
  EXPECT_EQ(bytes[334], 51);    // site.trust.pause_s
  EXPECT_EQ(bytes[338], 52);    // site.trust.steps
  EXPECT_EQ(bytes[342], 53);    // site.trust.step_squares
  EXPECT_EQ(bytes[350], 0xCA);  // site.trust.error_products = -54
  EXPECT_EQ(bytes[358], 55);    // site.trust.error_squares
  EXPECT_EQ(bytes[366], 1);     // site.house_is_implausible
  EXPECT_EQ(bytes[367], 1);     // lost_orders.is_found
  EXPECT_EQ(bytes[368], 69);    // findings.locked_readings
  for (std::size_t i = 370; i < 410; ++i) EXPECT_EQ(bytes[i], 0) << i;  // outlook
  EXPECT_EQ(bytes[410], 70);  // findings.wrong_energy_e6, the last field
  for (std::size_t i = 414; i < kRecordBytes - 4; ++i) EXPECT_EQ(bytes[i], 0) << i;
}

/// A ring of the program that ended its records with flash_writes_today: later fields read as 0.
TEST(RecordCodec, ARecordOfAnOlderLayoutIsRead) {
  RecordBytes bytes = bytes_of(full_record(7), 42);
  std::fill(bytes.begin() + 170, bytes.end(), std::uint8_t{0});
  seal(bytes);
  CycleRecord back;
  std::uint64_t number = 0;
  ASSERT_TRUE(decode_record(bytes, back, number));
  EXPECT_EQ(number, 42U);
  CycleRecord expected = full_record(7);
  expected.deadline_misses = expected.unanswered_orders = 0;
  expected.throughput = {};
  expected.price_level = {};
  expected.context_class = 0;
  expected.measurement.order_replaced = expected.measurement.warning = expected.is_tripped = false;
  expected.trip = {.reason = Reason::kStopRequested, .utc_s = 0};  // code 0; counts only if tripped
  expected.weak_answers = expected.replaced_orders = 0;
  expected.price.step_held = false;
  expected.price.held_centi_eur_per_mwh = 0;
  expected.reversals = {};
  expected.hold = {};
  expected.reserve_soc_e4 = expected.days_since_full = 0;
  expected.site = {};
  expected.measurement.order_ended = false;
  expected.ended_orders = 0;
  expected.lost_orders = {};
  expected.standing_price = {};
  expected.price_frozen = false;
  expected.findings = {};
  expected.followed = {};
  EXPECT_EQ(bytes_of(back, 42), bytes_of(expected, 42));
}

TEST(RecordCodec, ZerosAndUnknownCodesAreNoRecord) {
  CycleRecord record;
  std::uint64_t number = 0;
  EXPECT_FALSE(decode_record(RecordBytes{}, record, number));
  RecordBytes bytes = bytes_of(full_record(7), 42);
  bytes[24] = kModeCount;  // a mode of a later program, with a sound CRC
  seal(bytes);
  EXPECT_FALSE(decode_record(bytes, record, number));
}

TEST_F(Ring, NewestSurvivesReopeningAndTheRingWraps) {
  append(5, 1, 3);
  RingLog ring;
  CycleRecord newest;
  ASSERT_TRUE(ring.open(path_.c_str(), 5, error_));
  ASSERT_TRUE(ring.newest(newest));
  EXPECT_EQ(newest.cycle, 3);
  EXPECT_EQ(newest.counters.flash_writes_today, 25);
  append(5, 4, 9);
  EXPECT_EQ(cycles(), (std::vector<std::int64_t>{8, 9, 10, 11, 12}));
  EXPECT_EQ(std::filesystem::file_size(path_), kHeaderBytes + 5 * kRecordBytes);
}

TEST_F(Ring, OneOfAnOlderProgramIsReadAndContinuedInANewFile) {
  write_file(path_, older_ring(5, 3));
  EXPECT_EQ(cycles(), (std::vector<std::int64_t>{1, 2, 3}));
  RingLog ring;
  CycleRecord newest;
  ASSERT_TRUE(ring.open(path_.c_str(), 5, error_)) << error_.c_str();
  ASSERT_TRUE(ring.newest(newest));
  EXPECT_EQ(newest.cycle, 3);
  EXPECT_EQ(newest.context_class, 12);
  EXPECT_FALSE(newest.is_tripped);
  ASSERT_TRUE(ring.append(full_record(4)));
  EXPECT_EQ(cycles(), (std::vector<std::int64_t>{3, 4}));
  EXPECT_EQ(text_of_file(path_ + ".old"), older_ring(5, 3));
}

TEST_F(Ring, AnEmptyRingHasNoNewest) {
  RingLog ring;
  CycleRecord newest;
  ASSERT_TRUE(ring.open(path_.c_str(), 5, error_));
  EXPECT_FALSE(ring.newest(newest));
  EXPECT_TRUE(cycles().empty());
}

TEST_F(Ring, EveryTornByteOfTheNewestRecordCostsThatRecordOnly) {
  append(5, 1, 7);  // wrapped: 3 to 7, the newest in slot 2
  const std::string whole = text_of_file(path_);
  const std::size_t begin = kHeaderBytes + 2 * kRecordBytes;
  for (std::size_t i = 0; i < kRecordBytes; ++i) {
    std::string torn = whole;
    torn[begin + i] = static_cast<char>(torn[begin + i] ^ 0x40);
    write_file(path_, torn);
    ASSERT_EQ(cycles(), (std::vector<std::int64_t>{3, 4, 5, 6})) << "byte " << i;
    append(5, 8, 1);  // goes on in the torn slot
    ASSERT_EQ(cycles(), (std::vector<std::int64_t>{3, 4, 5, 6, 8})) << "byte " << i;
  }
}

/// Half of the new record, half of the old one, at every length: what a cut in the middle leaves.
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
    write_file(path_, torn);
    ASSERT_EQ(cycles(), (std::vector<std::int64_t>{2, 3})) << length << " bytes written";
  }
}

TEST_F(Ring, AFileCutAtEveryByteOfItsLastRecordStillOpens) {
  append(3, 1, 2);  // slots 1 and 2: the newest is last in the file
  const std::string whole = text_of_file(path_);
  for (std::size_t missing = 1; missing <= kRecordBytes; ++missing) {
    write_file(path_, whole.substr(0, whole.size() - missing));
    ASSERT_EQ(cycles(), (std::vector<std::int64_t>{1})) << missing << " bytes missing";
    append(3, 3, 1);
    ASSERT_EQ(cycles(), (std::vector<std::int64_t>{1, 3})) << missing << " bytes missing";
  }
}

TEST_F(Ring, AnotherCapacitySetsTheFileAsideAndTakesOver) {
  append(5, 1, 4);
  RingLog larger;
  CycleRecord newest;
  ASSERT_TRUE(larger.open(path_.c_str(), 9, error_)) << error_.c_str();
  ASSERT_TRUE(larger.newest(newest));
  EXPECT_EQ(newest.cycle, 4);
  ASSERT_TRUE(larger.append(full_record(5)));
  EXPECT_EQ(larger.newest_number(), 5U);
  EXPECT_TRUE(std::filesystem::exists(path_ + ".old"));
  EXPECT_FALSE(larger.damage().is_any());
}

/// The process that made the larger log died before it wrote to it.
TEST_F(Ring, TheNewestIsInTheNewFileFromItsBeginning) {
  append(5, 1, 4);
  append(9, 5, 0);
  RingLog ring;
  CycleRecord newest;
  ASSERT_TRUE(ring.open(path_.c_str(), 9, error_)) << error_.c_str();
  ASSERT_TRUE(ring.newest(newest));
  EXPECT_EQ(newest.cycle, 4);
}

TEST_F(Ring, WhatIsNoLogIsSetAsideAndTold) {
  write_file(path_, std::string(kHeaderBytes + 5 * kRecordBytes, 'x'));
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

/// Numbers are left out where a disk refused records; what stood in their places is not theirs.
TEST_F(Ring, NumbersMayBeLeftOut) {
  append(5, 1, 4);
  RingLog ring;
  ASSERT_TRUE(ring.open(path_.c_str(), 5, error_)) << error_.c_str();
  ASSERT_TRUE(ring.append(full_record(7), 7));
  EXPECT_EQ(ring.newest_number(), 7U);
  EXPECT_EQ(cycles(), (std::vector<std::int64_t>{3, 4, 7}));
  EXPECT_FALSE(ring.damage().is_any());
}

/// What an opening found lost, as the journal has it; empty = nothing.
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

TEST_F(Ring, EveryBrokenByteOfTheHeaderCostsNothingAndIsMended) {
  append(5, 1, 7);
  const std::string whole = text_of_file(path_);
  for (const std::size_t begin : {std::size_t{0}, std::size_t{2'048}}) {
    for (std::size_t i = begin; i < begin + 28; ++i) {
      write_file(path_, flipped(whole, i, 0x10));
      ASSERT_EQ(cycles(), (std::vector<std::int64_t>{3, 4, 5, 6, 7})) << "byte " << i;
      const std::string line = damage_line(path_, 5);
      ASSERT_EQ(has_code(line, "decisions.ring"), begin == 0) << "byte " << i;
      ASSERT_EQ(text_of_file(path_), whole) << "byte " << i;
    }
  }
}

TEST_F(Ring, WithoutAnyHeaderTheRecordsSayHowTheyLie) {
  append(5, 1, 7);
  const std::string whole = text_of_file(path_);
  std::string headless = whole;
  headless.replace(0, kHeaderBytes, kHeaderBytes, '\xff');
  for (const std::int64_t configured : {std::int64_t{5}, std::int64_t{9}}) {
    write_file(path_, headless);
    ASSERT_EQ(cycles(), (std::vector<std::int64_t>{3, 4, 5, 6, 7}));
    EXPECT_THAT(damage_line(path_, configured), Names("decisions.ring"));
  }
  CycleRecord newest;
  RingLog ring;
  ASSERT_TRUE(ring.open(path_.c_str(), 9, error_));
  ASSERT_TRUE(ring.newest(newest));
  EXPECT_EQ(newest.cycle, 7);
}

TEST_F(Ring, WithoutHeaderAndEndTheConfiguredSizeIsTried) {
  append(9, 1, 16);  // wrapped: the newest in slot 7
  std::string cut = text_of_file(path_);
  cut.replace(0, kHeaderBytes, kHeaderBytes, '\0');
  cut.resize(cut.size() - kRecordBytes);
  write_file(path_, cut);
  EXPECT_THAT(damage_line(path_, 9), Names("decisions.ring 1"));
  EXPECT_EQ(cycles(), (std::vector<std::int64_t>{9, 10, 11, 12, 13, 14, 15, 16}));
  EXPECT_EQ(std::filesystem::file_size(path_), kHeaderBytes + 9 * kRecordBytes);
}

/// One flipped byte anywhere, at places and with masks of a named seed: at most one record is lost,
/// what is lost is said, and what is left is what was written.
TEST_F(Ring, OneFlippedByteAnywhereCostsAtMostOneRecordAndIsTold) {
  constexpr std::int64_t kCapacity = 40;
  std::mt19937 random(20261123);
  for (const std::int64_t written : {std::int64_t{12}, std::int64_t{40}, std::int64_t{97}}) {
    std::filesystem::remove(path_);
    append(kCapacity, 1, written);
    const std::string whole = text_of_file(path_);
    const std::vector<std::int64_t> before = cycles();
    for (int draw = 0; draw < 1'500; ++draw) {
      const std::size_t at = random() % whole.size();
      const auto mask = static_cast<unsigned char>(1 + random() % 255);
      write_file(path_, flipped(whole, at, mask));
      const std::string line = damage_line(path_, kCapacity);
      const std::vector<std::int64_t> after = cycles();
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

/// Appends until it is killed; says on `told` when it has begun.
[[noreturn]] void append_for_ever(const char* path, int told) {
  RingLog ring;
  FileMessage error;
  if (!ring.open(path, 16, error)) _exit(1);
  while (ring.append(full_record(static_cast<std::int64_t>(ring.newest_number()) + 1))) {
    if (told >= 0 && write(told, "x", 1) != 1) _exit(3);
    told = -1;
  }
  _exit(2);
}

/// A writer that is killed at random instants: the next one goes on without a gap or a repetition.
/// Every third is killed at any instant since its birth, the others while they append.
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
    char told = 0;
    if (while_appending) {
      ASSERT_EQ(read(ends[0], &told, 1), 1) << "round " << round;
    }
    sleep_until_monotonic(clock_ns(CLOCK_MONOTONIC) + random() % 5'000'000);
    kill(child, SIGKILL);
    int status = 0;
    waitpid(child, &status, 0);
    close(ends[0]);
    ASSERT_TRUE(WIFSIGNALED(status)) << "round " << round;
    const std::vector<std::int64_t> found = cycles();
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
