// Commands of bess-edge as an operator types them: each exit code of the manual, and the
// reports about a controller that has tripped or ended.
#include <gmock/gmock.h>
#include <signal.h>

#include "tests/support/edge_answer.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::Not;

class EdgeCommands : public SiteTest {
 protected:
  EdgeCommands() : SiteTest(900) {}
  /// The words, with the configuration before or after them.
  ProgramOutput with_config(std::vector<std::string> words) {
    const ProgramOutput said = ask(words);
    words.insert(words.begin(), {"--config", config_});
    EXPECT_EQ(edge(words).exit_code, said.exit_code);
    return said;
  }
  int code_of(std::vector<std::string> words) { return with_config(std::move(words)).exit_code; }
};

/// Exit codes of shared/manual/reference/exit_codes.md.
TEST_F(EdgeCommands, ExitCodesAreTheDocumentedOnes) {
  config_ = site_.write_config();  // no listener
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
  EXPECT_EQ(code_of({"limit", "--charge", "0", "--for", "15m"}), 1);  // no [limits]
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
  start_site(1'200);
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
  EXPECT_EQ(ask({"record", "--for", "20m", "--out", recording}).exit_code, 0);
  EXPECT_EQ(code_of({"map", "check", "--against", recording}), 0);
  ChildProcess running = controller();
  ASSERT_NE(await_line(running, "mode=running"), "");
  EXPECT_EQ(code_of({"--check"}), 1);  // the battery is in use
  site_.market->signal(SIGKILL);
  ASSERT_NE(await_line(running, "mode=holding"), "");
  EXPECT_EQ(code_of({"status"}), 1);
  EXPECT_EQ(SimulatedSite::stop(running), 0);
  EXPECT_EQ(code_of({"status"}), 3);
}

TEST_F(EdgeCommands, AHealthyControllerIsExitCode0) {
  start_site(1'200);
  ChildProcess running = controller();
  int code = -1;
  for (int i = 0; i < 50 && code != 0; ++i) {
    ASSERT_NE(await_line(running, "mode=running"), "");
    code = ask({"status"}).exit_code;
  }
  EXPECT_EQ(code, 0);
  EXPECT_EQ(SimulatedSite::stop(running), 0);
}

TEST_F(EdgeCommands, AHoldWhileTrippedSaysThatItIsNotFollowed) {
  start_site(1'200);
  const int port = site_.battery_port;
  site_.battery.reset();
  site_.start_battery({"--fault", "excess-power"}, port);
  ChildProcess running = controller();
  ASSERT_NE(await_line(running, "reason=uncontrolled_power"), "");
  const auto hold = [&] { return ask({"hold", "-500", "--for", "6h"}).text; };
  EXPECT_THAT(hold(), Names("uncontrolled_power bess-edge clear --yes"));
  EXPECT_THAT(await_line(running, "utc="), Not(::testing::HasSubstr("reason=held")));
  EXPECT_EQ(ask({"clear", "--yes"}).exit_code, 0);
  EXPECT_THAT(hold(), Not(Names("uncontrolled_power")));
  EXPECT_EQ(SimulatedSite::stop(running), 0);
}

}  // namespace
}  // namespace bess
