#include <cstring>

#include "shared/host/file.h"
#include "tests/support/teachers.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/policy/rl/market_by_hand.h"
#include "workstation/base/random.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {
namespace {

Teacher teacher_of(Method method) {
  return network_teacher(method, {-14.5F, 15.25F, 21}, straight_price_map(), 91,
                         "bess-train on \"m\u00e4rkt.csv\", seed 1");
}

class TeacherFile : public testing::Test {
 protected:
  const TemporaryFolder folder;
  const std::string path = folder.file("teacher.bin");

  std::string saved(Method method) const {
    save_teacher(path, teacher_of(method));
    return read_file(path);
  }
  /// Loads `bytes` from the file and returns the UserError; empty if it loaded.
  std::string said_of(std::string_view bytes) const {
    write_file(path, bytes);
    return refusal_of([&] { (void)load_teacher(path); });
  }
  /// `bytes` of a file with another value at a place, under a valid checksum.
  static std::string changed(std::string bytes, std::size_t at, std::int32_t value) {
    std::memcpy(bytes.data() + at, &value, sizeof value);
    return resealed(bytes);
  }
  void expect_refused(std::string_view bytes, const std::string& what) const {
    EXPECT_THAT(said_of(bytes), Names(path)) << what;
  }
};

TEST_F(TeacherFile, RoundTripIsBitForBit) {
  for (const Method method : {Method::kC51, Method::kDqn}) {
    const std::string bytes = saved(method);
    const Teacher teacher = teacher_of(method);
    const Teacher read = load_teacher(path);
    EXPECT_EQ(read.method, teacher.method);
    EXPECT_EQ(std::memcmp(&read.support, &teacher.support, sizeof(Support)), 0);
    EXPECT_EQ(read.shape, teacher.shape);
    EXPECT_EQ(read.price_map.table(), teacher.price_map.table());
    ASSERT_EQ(read.parameters.size(), teacher.parameters.size());
    EXPECT_EQ(std::memcmp(read.parameters.data(), teacher.parameters.data(),
                          sizeof(float) * static_cast<std::size_t>(read.parameters.size())),
              0);
    EXPECT_EQ(read.provenance, teacher.provenance);
    EXPECT_TRUE(is_teacher_file(path));
    save_teacher(path, read);
    EXPECT_EQ(read_file(path), bytes);
  }
}

TEST_F(TeacherFile, WithTheProgramThatItAddsToItIsReadBack) {
  const MarketSteps market = simulated_market({2023, 1, 1}, 24);
  const auto program = program_of(market);
  for (const Method method : {Method::kC51, Method::kDqn}) {
    Teacher teacher = teacher_of(method);
    teacher.program = program;
    save_teacher(path, teacher);
    const std::string bytes = read_file(path);
    const Teacher read = load_teacher(path);
    EXPECT_EQ(read.method, method);
    ASSERT_TRUE(read.is_residual());
    EXPECT_EQ(read.parameters, teacher.parameters);
    for (std::size_t i = 0; i < market.steps.size(); i += 41) {
      EXPECT_EQ(TeacherPolicy(read).decide(market.steps[i], 0, 0.4),
                TeacherPolicy(teacher).decide(market.steps[i], 0, 0.4));
    }
    save_teacher(path, read);
    EXPECT_EQ(read_file(path), bytes);
    for (std::size_t part = 1; part < 20; ++part) {
      expect_refused(std::string_view(bytes).substr(0, bytes.size() * part / 20), "cut");
    }
  }
}

TEST_F(TeacherFile, ProvenanceOfAnyLengthIsReadBackOrCut) {
  for (const std::size_t length : {0u, 1u, 4096u, 4097u, 10'000u}) {
    Teacher teacher = teacher_of(Method::kDqn);
    teacher.provenance = std::string(length, 'p');
    save_teacher(path, teacher);
    std::string provenance;
    EXPECT_EQ(refusal_of([&] { provenance = load_teacher(path).provenance; }), "") << length;
    EXPECT_EQ(provenance, teacher.provenance.substr(0, 4096)) << length;
  }
}

TEST_F(TeacherFile, CutFlippedAndOtherBytesAreRefused) {
  const std::string bytes = saved(Method::kDqn);
  for (std::size_t length = 0; length < bytes.size(); length += length < 64 ? 1 : 4'999) {
    expect_refused(std::string_view(bytes).substr(0, length), fmt::format("{} bytes", length));
  }
  for (std::size_t less = 1; less <= 9; ++less) {
    expect_refused(std::string_view(bytes).substr(0, bytes.size() - less), "cut");
  }
  std::vector<std::size_t> places{0, 7, 8, 11, 12, 16, bytes.size() - 4, bytes.size() - 1};
  Random random(92);
  while (places.size() < 50) places.push_back(random.index(bytes.size()));
  for (const std::size_t at : places) {
    std::string damaged = bytes;
    damaged[at] = static_cast<char>(damaged[at] ^ static_cast<char>(1 + random.index(255)));
    expect_refused(damaged, fmt::format("byte {}", at));
  }
  for (const std::string& other :
       {bytes + "x", bytes + bytes, std::string(), std::string("minute_utc,indicative_eur_mwh\n"),
        std::string(1000, '\0'), std::string("BESSTCHR")}) {
    expect_refused(other, other.substr(0, 20));
  }
  EXPECT_FALSE((write_file(path, "BESSTCH"), is_teacher_file(path)));
  for (const std::string& other : {folder.file("."), folder.file("missing.bin")}) {
    EXPECT_THAT(refusal_of([&] { (void)load_teacher(other); }), Names(other));
  }
}

/// A file of version 2 has nothing between its origin and its parameters.
TEST_F(TeacherFile, AnOlderOneIsReadWithoutTrainingConditions) {
  Teacher teacher = teacher_of(Method::kDqn);
  std::string bytes = saved(Method::kDqn);
  const std::size_t count_at = bytes.find(teacher.provenance) + teacher.provenance.size();
  bytes.erase(count_at, sizeof(std::uint32_t));  // of the circumstances: none
  bytes[8] = 2;
  EXPECT_EQ(said_of(resealed(bytes)), "");
  const Teacher read = load_teacher(path);
  EXPECT_TRUE(read.learnt_for.empty());
  EXPECT_EQ(std::memcmp(read.parameters.data(), teacher.parameters.data(),
                        sizeof(float) * static_cast<std::size_t>(read.parameters.size())),
            0);
}

TEST_F(TeacherFile, OtherVersionNamesBoth) {
  std::string bytes = saved(Method::kDqn);
  bytes[8] = 5;
  EXPECT_THAT(said_of(bytes), Names(path + " 5 2 4"));
}

/// Fields in the file: magic 8, version 4, then these.
constexpr std::size_t kMethodAt = 12, kSupportMinAt = 16, kSupportMaxAt = 20, kSupportCountAt = 24,
                      kShapeAt = 28, kTableAt = 44;

/// The checksum is valid, the contents are not: a file of another program or a later version.
TEST_F(TeacherFile, SoundChecksumOverImpossibleContentsIsRefused) {
  const struct {
    const char* what;
    std::size_t at;
    std::int32_t value;
  } cases[] = {{"method", kMethodAt, 7},
               {"a program that adds to a program", kMethodAt, 0x102},
               {"no atoms", kSupportCountAt, 0},
               {"negative atoms", kSupportCountAt, -1},
               {"very many atoms", kSupportCountAt, 0x7FFFFFFF},
               {"one atom", kSupportCountAt, 1},
               {"support upside down", kSupportMinAt, 0x42C80000},  // 100.0F
               {"support not a number", kSupportMaxAt, 0x7FC00000},
               {"inputs", kShapeAt, 6},
               {"hidden", kShapeAt + 4, 255},
               {"outputs", kShapeAt + 12, 1'000'000},
               {"price table", kTableAt + 800, 0},
               {"provenance length", kTableAt + 2 * kPriceCount, 0x7FFFFFFF}};
  for (const Method method : {Method::kC51, Method::kDqn}) {
    const std::string sound = saved(method);
    for (const auto& c : cases) {
      expect_refused(changed(sound, c.at, c.value),
                     fmt::format("{}, {}", method_name(method), c.what));
    }
  }
}

/// Until November 2026 a teacher could have inputs in addition to the student's: a bit each.
TEST_F(TeacherFile, WithInputsOfItsOwnIsRefusedByThatName) {
  const std::string sound = saved(Method::kC51);
  EXPECT_EQ(said_of(changed(sound, kMethodAt, 0)), "") << "none: as before";
  for (int bit = 12; bit < 17; ++bit) {
    EXPECT_THAT(said_of(changed(sound, kMethodAt, 1 << bit)),
                Names(path + " [train] input_... bess-train train"));
  }
}

TEST(Methods, NamesReadBack) {
  for (const Method method : {Method::kC51, Method::kDqn}) {
    EXPECT_EQ(parse_method(method_name(method)), method);
  }
  EXPECT_THAT(refusal_of([] { (void)parse_method("ppo"); }), Names("c51 dqn sdp"));
}

}  // namespace
}  // namespace bess
