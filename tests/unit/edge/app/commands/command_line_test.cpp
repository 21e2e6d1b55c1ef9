// Command lines of bess-edge in this process: option positions, messages for typing errors, and
// refusals before a file is read.
#include <gmock/gmock.h>

#include <sstream>

#include "tests/support/edge_words.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::StartsWith;

TEST(EdgeCommandLine, EveryCommandHasHelpWithExitCodes) {
  const std::string general = run_edge_words({"--help"}).text();
  std::istringstream commands(general.substr(general.find("Subcommands:\n")));
  std::string line;
  int count = 0;
  for (std::getline(commands, line); std::getline(commands, line) && !line.empty(); ++count) {
    std::vector<std::string> words = {line.substr(2, line.find(' ', 2) - 2)};
    if (words.front() == "map") words.emplace_back("check");
    words.emplace_back("--help");
    const EdgeOutput said = run_edge_words(words);
    EXPECT_EQ(said.exit_code, 0) << line;
    EXPECT_THAT(said.text(), ::testing::ContainsRegex("Exit codes:\n  0 ")) << line;
  }
  EXPECT_EQ(count, 12);
  EXPECT_EQ(run_edge_words({"--version"}).exit_code, 0);
  EXPECT_THAT(run_edge_words({"--version"}).text(), StartsWith("bess-edge "));
}

TEST(EdgeCommandLine, ATypingErrorIsReportedWithASuggestion) {
  const std::pair<std::vector<std::string>, const char*> slips[] = {
      {{"stat"}, "stat status --help bess-edge"},
      {{"stauts"}, "stauts status"},
      {{"--config", "x", "stauts"}, "stauts status"},
      {{"relase", "--yes"}, "relase release"},
      {{"check"}, "check --check"},
      {{"selftest"}, "selftest --self-test"},
      {{"plutonium"}, "plutonium --help bess-edge"},
      {{"--confg", "x"}, "--confg --config --help bess-edge"},
      {{"--confg=x", "--check"}, "--confg=x --config"},
      {{"status", "--jsno"}, "--jsno --json --help bess-edge status"},
      {{"status", "--follw"}, "--follow"},
      {{"log", "--lst", "3"}, "--last"},
      {{"hold", "100", "--fro", "2h"}, "--for --help bess-edge hold"},
      {{"status", "--cycles", "3"}, "--cycles --help bess-edge status"},
      {{"--cycles", "3", "status"}, "--cycles --help bess-edge status"},
      {{"map", "chek"}, "chek check bess-edge map"},
      {{"log", "--last"}, "--last --help bess-edge log"},
      {{"--config"}, "--config --help bess-edge"},
  };
  for (const auto& [words, complaint] : slips) {
    const EdgeOutput said = run_edge_words(words);
    EXPECT_EQ(said.exit_code, 2) << complaint;
    EXPECT_THAT(said.text(), ::testing::AllOf(StartsWith("bess-edge: "), Names(complaint)));
    EXPECT_EQ(said.text().find('\n'), said.text().size() - 1) << said.text();
  }
}

TEST(EdgeCommandLine, MissingArgumentsAreReportedBeforeAFileIsRead) {
  const std::pair<std::vector<std::string>, const char*> incomplete[] = {
      {{"status", "--json", "--prometheus"}, "--json --prometheus"},
      {{"hold", "100"}, "--for --release"},
      {{"hold", "--release", "--for", "2h"}, "--release --help bess-edge hold"},
      {{"hold", "100", "200", "--for", "2h"}, "200"},
      {{"hold", "-100", "--for", "1m"}, "--for 2m 7d 2h 1h30m 1m"},
      {{"limit"}, "--for --clear"},
      {{"limit", "--clear", "--for", "1s"}, "--for --clear"},
      {{"limit", "--for", "15m"}, "--charge --discharge"},
      {{"limit", "--clear", "--charge", "0"}, "--clear"},
      {{"record"}, "--for --help bess-edge record"},
      {{"record", "--for", "0s"}, "--for 1s 7d"},
      {{"map", "check"}, "--against --help bess-edge map check"},
      {{"map", "check", "--against", "a", "--map", "m", "--config", "c"}, "--map --config"},
      {{"map", "check", "--against", "a", "--variant", "v"}, "--variant --map"},
      {{"map", "check", "--against", "a", "--map", "m", "--steps", "--json"}, "--json --steps"},
      {{"log", "--last", "0"}, "--last 0"},
      {{"log", "--since", "now"}, "--since 14:32"},
      {{"log", "--at", "14:32", "--last", "3"}, "--at"},
      {{"--config", ""}, "--config"},
      {{"signature", "--config", "x"}, "--config"},
  };
  for (const auto& [words, complaint] : incomplete) {
    const EdgeOutput said = run_edge_words(words);
    EXPECT_EQ(said.exit_code, 2) << complaint;
    EXPECT_THAT(said.text().substr(said.text().find("bess-edge: ")), Names(complaint));
  }
}

}  // namespace
}  // namespace bess
