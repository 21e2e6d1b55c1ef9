// The commands of bess-edge as an operator types them: each exit
// code that edge/README.md promises, and what is said of a controller that has tripped or ended.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <filesystem>

#include "tests/support/edge_answer.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;
using ::testing::StartsWith;

class EdgeCommands : public ::testing::Test {
 protected:
  static constexpr std::int32_t kScale = 900;

  void start_site() {
    site_.start_battery();
    site_.start_market({}, SimulatedSite::minute_prices(1'200));
    config_ = site_.commission();
  }
  /// The words, with the configuration where an operator may put it: before or behind.
  Said with_config(std::vector<std::string> words) {
    std::vector<std::string> before = {"--config", config_};
    before.insert(before.end(), words.begin(), words.end());
    words.insert(words.end(), {"--config", config_});
    const Said said = edge(words);
    EXPECT_EQ(edge(before).exit_code, said.exit_code);
    return said;
  }
  int code_of(std::vector<std::string> words) { return with_config(std::move(words)).exit_code; }

  SimulatedSite site_{kScale};
  std::string config_;
};

/// The table of exit codes in edge/README.md, row by row; the command line's 2 is above.
TEST_F(EdgeCommands, ExitCodesAreTheDocumentedOnes) {
  config_ = site_.write_config();  // nobody listens
  EXPECT_EQ(code_of({"--check"}), 1);
  EXPECT_EQ(code_of({"--self-test"}), 1);
  EXPECT_EQ(code_of({"--cycles", "1"}), 1);
  EXPECT_EQ(code_of({"commission", "--yes"}), 1);
  EXPECT_EQ(code_of({"commission"}), 2);
  EXPECT_EQ(code_of({"release", "--yes"}), 1);
  EXPECT_EQ(code_of({"release"}), 2);
  EXPECT_EQ(code_of({"clear", "--yes"}), 1);  // there is no log yet
  EXPECT_EQ(code_of({"log"}), 1);
  EXPECT_EQ(code_of({"status"}), 3);
  EXPECT_EQ(code_of({"limit", "--for", "15m"}), 1);  // no [limits]
  EXPECT_EQ(code_of({"hold", "5000", "--for", "2h"}), 1);
  EXPECT_EQ(code_of({"hold", "-4001", "--for", "2h"}), 1);
  EXPECT_EQ(code_of({"record", "--for", "1s", "--out", site_.folder.file("none.jsonl")}), 1);
  EXPECT_EQ(code_of({"map", "check", "--against", "/nonexistent"}), 1);
  EXPECT_EQ(edge({"signature"}).exit_code, 0);
  config_ = "/nonexistent";
  for (const char* command : {"status", "log", "--check", "--self-test"})
    EXPECT_EQ(code_of({command}), 1);
}

TEST_F(EdgeCommands, ExitCodesWhereAllIsWell) {
  start_site();
  EXPECT_EQ(code_of({"--check"}), 0);
  EXPECT_EQ(code_of({"--self-test"}), 0);
  EXPECT_EQ(code_of({"commission", "--yes"}), 0);
  EXPECT_EQ(code_of({"--cycles", "1"}), 0);
  EXPECT_EQ(code_of({"release", "--yes"}), 0);
  EXPECT_EQ(code_of({"clear", "--yes"}), 0);
  EXPECT_EQ(code_of({"clear"}), 0);  // nothing to clear
  EXPECT_EQ(code_of({"log"}), 0);
  EXPECT_EQ(code_of({"hold", "100", "--for", "2h"}), 0);
  EXPECT_EQ(code_of({"hold", "--release"}), 0);
  const std::string recording = site_.folder.file("device.jsonl");
  EXPECT_EQ(edge({"record", "--for", "20m", "--config", config_, "--out", recording}).exit_code, 0);
  EXPECT_EQ(code_of({"map", "check", "--against", recording}), 0);
  ChildProcess controller({edge_program(), "--config", config_});
  ASSERT_NE(await_line(controller, "mode=running"), "");
  EXPECT_EQ(code_of({"--check"}), 1);  // the battery is in use
  site_.market->signal(SIGKILL);
  ASSERT_NE(await_line(controller, "mode=holding"), "");
  EXPECT_EQ(code_of({"status"}), 1);
  EXPECT_EQ(SimulatedSite::stop(controller), 0);
  EXPECT_EQ(code_of({"status"}), 3);
}

TEST_F(EdgeCommands, AHealthyControllerIsExitCode0) {
  start_site();
  ChildProcess controller({edge_program(), "--config", config_});
  int code = -1;
  for (int i = 0; i < 50 && code != 0; ++i) {
    ASSERT_NE(await_line(controller, "mode=running"), "");
    code = edge({"status", "--config", config_}).exit_code;
  }
  EXPECT_EQ(code, 0);
  EXPECT_EQ(SimulatedSite::stop(controller), 0);
}

/// A hold cannot make a battery be driven that the supervision has given back: that is said where
/// it is asked for.
TEST_F(EdgeCommands, AHoldWhileTrippedSaysThatItIsNotFollowed) {
  start_site();
  const int port = site_.battery_port;
  site_.battery.reset();
  site_.start_battery({"--fault", "excess-power"}, port);
  ChildProcess controller({edge_program(), "--config", config_});
  ASSERT_NE(await_line(controller, "reason=uncontrolled_power"), "");
  const auto hold = [&] { return edge({"hold", "-500", "--for", "6h", "--config", config_}).text; };
  EXPECT_THAT(hold(), Names("uncontrolled_power bess-edge clear --yes"));
  EXPECT_THAT(await_line(controller, "utc="), Not(HasSubstr("reason=held")));
  EXPECT_EQ(edge({"clear", "--yes", "--config", config_}).exit_code, 0);
  EXPECT_THAT(hold(), Not(Names("uncontrolled_power")));
  EXPECT_EQ(SimulatedSite::stop(controller), 0);
}

}  // namespace
}  // namespace bess
