// Run program that is killed repeatedly, meets a full disk, is interrupted or not proved.
#include <gmock/gmock.h>
#include <signal.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>

#include "tests/support/thorough.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/runs/idle_run.h"

namespace bess {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;
using testing::AllOf;
using testing::HasSubstr;

constexpr std::uint64_t kSeed = 20230401;

const std::string kIdle =
    std::string(kIdleCosts) +
    "[train]\nsteps = 60\nbatch_size = 96\nvalidate_every = 20\n"
    "[distil]\nepochs = 16\nlearning_rate = 0.03\nrepair_rounds = 2\nrepair_epochs = 1\n";

class KilledRun : public IdleRun {
 protected:
  KilledRun() { write_minute_file(prices_, small_series(31), ""); }

  [[nodiscard]] std::vector<std::string> arguments(const std::string& out,
                                                   std::vector<std::string> more = {}) const {
    std::vector<std::string> words{"run",       "--prices", prices_, "--config", config_,
                                   "--threads", "2",        "--out", out};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  [[nodiscard]] std::vector<std::string> command(const std::string& out,
                                                 std::vector<std::string> more = {}) const {
    std::vector<std::string> words = arguments(out, std::move(more));
    words.insert(words.begin(), BESS_TRAIN_PROGRAM);
    return words;
  }

  std::string prices_ = path("prices.csv.gz");
  std::string config_ = written("idle.toml", kIdle + kNoThresholds);
};

// BESS_KILLS=50 in the environment kills fifty times.
TEST_F(KilledRun, AtRandomAndOnAFullDiskEndsWithTheSameBytes) {
  const char* asked = std::getenv("BESS_KILLS");
  const int kills = asked != nullptr ? std::atoi(asked) : few_or_all(3, 10);
  const std::string whole = path("whole");
  const auto start = Clock::now();
  said(arguments(whole));
  std::chrono::duration<double> longest_s = 0.8 * (Clock::now() - start);
  const auto expected = contents(whole);

  const std::string out = path("killed");
  std::string limited = "trap '' XFSZ; ulimit -f 64; exec";  // no file above 32 KiB
  for (const std::string& word : command(out)) limited += " '" + word + "'";
  ChildProcess full({"/bin/sh", "-c", limited});
  EXPECT_THAT(full.read_all(), Names("teacher.checkpoint"));
  EXPECT_EQ(full.wait(), 1);
  EXPECT_FALSE(fs::exists(out + "/teacher.bin"));

  Random random(kSeed);
  for (int killed = 0, finished = 0; killed < kills;) {
    ASSERT_LT(finished, 4 * kills) << "it ends before it can be killed";
    ChildProcess run(command(out, {"--resume"}));
    const auto end = Clock::now() + random.uniform() * longest_s;
    while (Clock::now() < end && !run.has_ended()) usleep(2'000);
    run.signal(SIGKILL);
    const int exit_code = run.wait();
    ASSERT_THAT(exit_code, testing::AnyOf(0, 128 + SIGKILL)) << run.read_all();
    if (exit_code != 0) {
      ++killed;
      continue;
    }
    ++finished;
    expect_same(out, expected);
    fs::remove_all(out);  // restart, or the rest of the kills would have no effect
    longest_s *= 0.8;     // the machine has become faster, or most of the work was done
  }
  said(arguments(out, {"--resume"}));
  expect_same(out, expected);

  // Only the modified stage is repeated; after that nothing is left to do.
  write_file(out + "/student_weights.h", "// mine");
  fs::remove(out + "/evaluation.csv");
  const auto trained = fs::last_write_time(out + "/teacher.bin");
  said({"run", "--resume", "--out", out});
  EXPECT_EQ(fs::last_write_time(out + "/teacher.bin"), trained) << "nothing is trained again";
  expect_same(out, expected);

  // A configuration edited afterwards differs from that of the run.
  write_file(out + "/config.toml", "[battery]\npower_w = 5000000\n");
  EXPECT_THAT(said({"report", "--run", out}, 1), Names(out));

  EXPECT_THAT(said({"runs", "compare", whole, out}), Names(whole + " " + out + " +0.0"));
}

TEST_F(KilledRun, InterruptedItReportsHowToContinueAndKeepsTheTrainingSoFar) {
  config_ = written("long.toml",
                    "[train]\nmethod = \"c51\"\nsteps = 10000000\nvalidate_every = 1\n"
                    "batch_size = 16\n");
  const std::string out = path("run");
  ChildProcess run(command(out));
  for (int i = 0; i < 30'000 && !fs::exists(out + "/teacher.checkpoint"); ++i) usleep(10'000);
  ASSERT_TRUE(fs::exists(out + "/teacher.checkpoint"));
  run.signal(SIGINT);
  EXPECT_THAT(run.read_all(), Names("run --resume --out " + out));
  EXPECT_EQ(run.wait(), 3);
  EXPECT_THAT(read_file(out + "/run.json"), testing::Not(HasSubstr("\"teacher\":	{")));
  for (const auto& entry : fs::directory_iterator(out)) {
    EXPECT_THAT(entry.path().string(), testing::Not(HasSubstr(".part."))) << "half-written";
  }
}

TEST_F(KilledRun, AFailedProofIsReportedWithEveryRoundAndNotRepeated) {
  config_ = written("fail.toml", kIdle +
                                     "[correction]\nlow_price_eur_per_mwh = 200\n"
                                     "high_price_eur_per_mwh = 201\n");
  const std::string out = path("run");
  const auto expected = Names("3 201 EUR/MWh [distil] [correction] epochs repair_rounds " + out +
                              "/report.html --from-teacher " + out + " --config");
  EXPECT_THAT(said(arguments(out), 1), AllOf(expected, Names("1 3")));
  EXPECT_EQ(std::ranges::count(read_file(out + "/proof_rounds.csv"), '\n'), 1 + 3 * 3);
  EXPECT_THAT(read_file(out + "/report.html"),
              AllOf(HasSubstr("href=\"#failure\""), Names("201 EUR/MWh")));
  EXPECT_FALSE(fs::exists(out + "/student.json"));
  EXPECT_FALSE(fs::exists(out + "/teacher.checkpoint")) << "no longer needed";
  const auto before = contents(out);
  const std::string kept = path("kept");
  fs::copy(out, kept, fs::copy_options::recursive);
  const auto distilled = fs::last_write_time(out + "/proof_rounds.csv");
  EXPECT_THAT(said(arguments(out, {"--resume"}), 1), expected);
  EXPECT_EQ(fs::last_write_time(out + "/proof_rounds.csv"), distilled);
  expect_same(out, before);
  fs::remove(out + "/report.html");
  said({"report", "--run", out});
  EXPECT_THAT(read_file(out + "/report.html"), HasSubstr("\"exported\":\"unproved student\""));
  fs::remove_all(out);
  fs::copy(kept, out, fs::copy_options::recursive);

  // Nothing is lost: with a corrected configuration its teacher continues to a proved student.
  config_ = written("mended.toml", kIdle + kNoThresholds);
  const std::string repaired = path("repaired");
  EXPECT_THAT(said(arguments(repaired, {"--from-teacher", out})), Names(out + "/teacher.bin"));
  EXPECT_TRUE(read_file(repaired + "/teacher.bin") == read_file(out + "/teacher.bin"));
  expect_same(out, before);
}

}  // namespace
}  // namespace bess
