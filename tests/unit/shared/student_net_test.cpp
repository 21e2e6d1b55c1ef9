// Integer student, bit for bit: golden vectors of nets drawn from fixed seeds. Every compiler and
// machine must produce the same file; a difference is a change of function. Rewrite the golden file
// with the command in its first line.
#include "shared/nn/student_net.h"

#include <gtest/gtest.h>

#include <sstream>

#include "shared/nn/exported_student.h"
#include "tests/support/golden_file.h"
#include "tests/support/integer_nets.h"

namespace bess {
namespace {

constexpr const char* kGoldenPath = BESS_SOURCE_DIR "/tests/data/golden/student_net.txt";
constexpr int kNets = 6;
constexpr std::uint64_t kSeed = 2'024;
constexpr int kStates = 20'000;
constexpr int kWrittenOut = 4;

/// One line per net: seed, weights hash, checksums of decisions and of logits, count of each
/// action; then some states in full.
std::string golden_text() {
  std::ostringstream out;
  out << "# generator shared_test, version 1, seed " << kSeed
      << ", command: BESS_UPDATE_GOLDEN=1 shared_test --gtest_filter=StudentNet.Golden*\n";
  for (int n = 0; n < kNets; ++n) {
    const std::uint64_t seed = kSeed + static_cast<std::uint64_t>(n);
    const StudentNet net = random_integer_net(seed);
    Random random(derive_seed(seed, 1));
    Crc32 decisions, all_logits;
    int count[kActionCount] = {};
    std::ostringstream written_out;
    for (int i = 0; i < kStates; ++i) {
      const LatticeState s = random_lattice_state(random);
      std::int16_t x[kStudentInputs];
      std::int32_t logits[kActionCount];
      net.quantise(s, x);
      net.propagate(x, logits);
      const Action action = net.decide(s);
      decisions.add_byte(static_cast<std::uint8_t>(action));
      for (const std::int32_t z : logits) all_logits.add_integer(z);
      ++count[static_cast<int>(action)];
      if (i < kWrittenOut) {
        written_out << "state " << s.minute_of_quarter_hour << ' ' << s.quarter_hour << ' '
                    << s.context_class << ' ' << s.soc_index << ' ' << s.price_eur_per_mwh
                    << " logits " << logits[0] << ' ' << logits[1] << ' ' << logits[2] << ' '
                    << action_name(action) << '\n';
      }
    }
    out << "net " << seed << std::hex << " weights " << student_weights_hash(net) << " decisions "
        << decisions.value() << " logits " << all_logits.value() << std::dec << " actions "
        << count[0] << ' ' << count[1] << ' ' << count[2] << '\n'
        << written_out.str();
  }
  return out.str();
}

TEST(StudentNet, GoldenVectors) { expect_golden(kGoldenPath, golden_text()); }

TEST(StudentNet, HashesSeeEveryNumber) {
  const StudentNet net = random_integer_net(1);
  const std::uint32_t hash = student_weights_hash(net);
  const auto differs = [hash](StudentNet changed, auto change) {
    change(changed);
    return student_weights_hash(changed) != hash;
  };
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.price_map[2'000] += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.layer1.weight[4][63] += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.layer1.bias[0] += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.relu1.shift += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.layer2.weight[63][31] += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.relu2.shift += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.layer3.weight[0][0] += 1; }));
  EXPECT_TRUE(differs(net, [](StudentNet& n) { n.layer3.bias[2] += 1; }));
  EXPECT_FALSE(differs(net, [](StudentNet&) {}));
}

TEST(StudentNet, TheExportedStudentAnswersItsSelfChecks) {
  EXPECT_EQ(count_exported_self_check_failures(), 0);
}

}  // namespace
}  // namespace bess
