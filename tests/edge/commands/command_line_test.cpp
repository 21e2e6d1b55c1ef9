// The words of bess-edge in this process: where they may stand, what is said of a slip, and what
// each command refuses before it reads a file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "edge/commands/command_line.h"
#include "edge/commands/command_list.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::StartsWith;

struct Said {
  int exit_code;
  std::string text;  ///< stdout, then stderr
};

Said said_to(const std::vector<std::string>& words) {
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  const int exit_code = run_command_line({words.begin(), words.end()});
  std::string text = testing::internal::GetCapturedStdout();
  return {exit_code, text + testing::internal::GetCapturedStderr()};
}

TEST(EdgeWords, HelpAndVersionAreWordsToo) {
  const std::string general = said_to({"--help"}).text;
  for (const auto& words :
       {std::vector<std::string>{"help"}, {"-h"}, {"help", "run"}, {"help", "--help"}}) {
    const Said said = said_to(words);
    EXPECT_EQ(said.exit_code, 0);
    EXPECT_EQ(said.text, general);
  }
  for (const EdgeCommand* const known : kCommands) {
    const std::string command(known->name);
    const Said said = said_to({"help", command});
    EXPECT_EQ(said.exit_code, 0) << command;
    EXPECT_EQ(said.text, said_to({command, "--help"}).text);
    EXPECT_EQ(said.text, said_to({"--help", command}).text);
    EXPECT_THAT(said.text, ::testing::ContainsRegex("Exit codes:[ \n]+0 ")) << command;
    const bool is_row = general.find("bess-edge " + command) != general.npos;
    EXPECT_TRUE(is_row || command == "run") << command;
  }
  EXPECT_EQ(said_to({"version"}).exit_code, 0);
  EXPECT_EQ(said_to({"version"}).text, said_to({"--version"}).text);
  EXPECT_THAT(said_to({"version"}).text, StartsWith("bess-edge "));
}

TEST(EdgeWords, ASlipIsToldWithWhatWasProbablyMeant) {
  const std::pair<std::vector<std::string>, const char*> slips[] = {
      {{"stat"}, "unknown command stat; did you mean status? (see bess-edge --help)"},
      {{"stauts"}, "unknown command stauts; did you mean status?"},
      {{"relase", "--yes"}, "unknown command relase; did you mean release?"},
      {{"hlep"}, "unknown command hlep; did you mean help?"},
      {{"check"}, "unknown command check; did you mean --check?"},
      {{"selftest"}, "unknown command selftest; did you mean --self-test?"},
      {{"help", "stauts"}, "unknown command stauts; did you mean status?"},
      {{"plutonium"}, "unknown command plutonium (see bess-edge --help)"},
      {{"--confg", "x"}, "unknown option --confg; did you mean --config? (see bess-edge --help)"},
      {{"--config=x", "--check"}, "unknown option --config=x; did you mean --config?"},
      {{"status", "--jsno"},
       "unknown option --jsno; did you mean --json? (see bess-edge status --help)"},
      {{"status", "--follw"}, "did you mean --follow?"},
      {{"log", "--lst", "3"}, "did you mean --last?"},
      {{"hold", "100", "--fro", "2h"}, "did you mean --for? (see bess-edge hold --help)"},
      {{"status", "--cycles", "3"}, "unknown option --cycles (see bess-edge status --help)"},
      {{"--json", "--cycles", "3", "status"},
       "unknown option --cycles (see bess-edge status --help)"},
      {{"map", "chek"},
       "map needs what is to be done: map check --against FILE (see bess-edge map check"},
      {{"log", "--last"}, "a value is missing after --last (see bess-edge log --help)"},
      {{"--config"}, "a value is missing after --config (see bess-edge --help)"},
  };
  for (const auto& [words, complaint] : slips) {
    const Said said = said_to(words);
    EXPECT_EQ(said.exit_code, 2) << complaint;
    EXPECT_THAT(said.text, AllOf(StartsWith("bess-edge: "), HasSubstr(complaint)));
    EXPECT_EQ(said.text.find('\n'), said.text.size() - 1) << said.text;
  }
}

TEST(EdgeWords, WhatACommandNeedsIsToldBeforeAFileIsRead) {
  const std::pair<std::vector<std::string>, const char*> incomplete[] = {
      {{"status", "--json", "--prometheus"}, "--json and --prometheus exclude each other"},
      {{"hold", "100"}, "hold needs a power in W and --for DURATION, or --release alone"},
      {{"hold", "--release", "--for", "2h"}, "or --release alone (see bess-edge hold --help)"},
      {{"hold", "100", "200", "--for", "2h"}, "unknown option 200"},
      {{"hold", "-100", "--for", "1m"}, "--for needs 2m to 7d, such as 2h or 1h30m, not 1m"},
      {{"limit"}, "limit needs either --for DURATION or --clear"},
      {{"limit", "--clear", "--for", "1s"}, "limit needs either --for DURATION or --clear"},
      {{"record"}, "record needs --for DURATION (see bess-edge record --help)"},
      {{"record", "--for", "0s"}, "--for needs 1s to 7d"},
      {{"map", "check"}, "map check needs --against FILE (see bess-edge map check --help)"},
      {{"map", "check", "--against", "a", "--map", "m", "--config", "c"},
       "--map and --config exclude each other"},
      {{"map", "check", "--against", "a", "--variant", "v"}, "--variant needs --map"},
      {{"map", "check", "--against", "a", "--map", "m", "--steps", "--json"}, "leave --json out"},
      {{"log", "--last", "0"}, "--last needs a whole number above 0, not 0"},
      {{"log", "--since", "now"}, "--since needs a moment such as 14:32, "},
      {{"log", "--at", "14:32", "--last", "3"}, "--at is one cycle"},
      {{"--config", ""}, "--config needs a file, not an empty text"},
      {{"signature", "--config", "x"}, "unknown option --config"},
  };
  for (const auto& [words, complaint] : incomplete) {
    const Said said = said_to(words);
    EXPECT_EQ(said.exit_code, 2) << complaint;
    EXPECT_THAT(said.text, AllOf(StartsWith("bess-edge: "), HasSubstr(complaint)));
  }
}

/// One after another in one process: nothing of a command is left to the next.
TEST(EdgeWords, CommandsRunInThisProcess) {
  EXPECT_THAT(said_to({"signature"}).text, HasSubstr("signature="));
  EXPECT_EQ(said_to({"log", "--config", "/nonexistent"}).exit_code, 1);
  EXPECT_EQ(
      said_to({"map", "check", "--against", "/nonexistent", "--map", "/nonexistent"}).exit_code, 1);
}

/// Nobody listens: it says what it would write all the same, what cannot be reached, and that it is
/// not well.
TEST(EdgeWords, ACheckRunsInThisProcess) {
  const TemporaryFolder folder;
  const std::string config = folder.write("edge.toml", R"([battery]
map = ")" BESS_SOURCE_DIR R"(/edge/maps/simulator.toml"
host = "127.0.0.1"
port = 1
[price]
url = "http://127.0.0.1:1/prices"
timeout_ms = 100
)");
  for (int i = 0; i < 2; ++i) {
    const Said said = said_to({"--check", "--config", config});
    EXPECT_EQ(said.exit_code, 1);
    EXPECT_THAT(said.text, AllOf(HasSubstr("student    "), HasSubstr("map        simulator"),
                                 HasSubstr("\ncharge     0x"), HasSubstr("\nrelease    0x"),
                                 HasSubstr("battery at 127.0.0.1:1"), HasSubstr("price from ")));
  }
}

}  // namespace
}  // namespace bess
