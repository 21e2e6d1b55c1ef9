// bess-train refuses senseless command lines: one clear line with the correction, exit code 2 for a
// bad command line and 1 for bad input, and nothing is written.
#include "tests/support/bad_command_lines.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <cstring>
#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/minute_file.h"
#include "shared/host/toml_document.h"
#include "tests/support/signal_handler.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/toml_mistakes.h"
#include "tests/support/train_commands.h"
#include "tests/support/user_error_of.h"
#include "workstation/cli/commands.h"
#include "workstation/correction/student/student_file.h"

namespace bess {
namespace {

// GOOD is a minute file, STUDENT a student's, NONE nothing, FOLDER a folder, EMPTY and GARBAGE
// files, OUT a file that must not be created.
constexpr BadCommandLine kCases[] = {
    // Subcommands.
    {"", 2, "bess-train --help"},
    {"prices", 2, "bess-train prices --help"},
    {"runs", 2, "bess-train runs --help"},
    {"run", 2, "--out bess-train run --help"},
    {"train", 2, "bess-train train --help"},
    {"distil", 2, "bess-train distil --help"},
    {"evaluate", 2, "bess-train evaluate --help"},
    {"backtest", 2, "bess-train backtest --help"},
    {"size", 2, "bess-train size --help"},
    {"impact", 2, "--out bess-train impact --help"},
    {"impact --fleet-mw many --out OUT", 1, "--fleet-mw many"},
    {"impact --policy foresight --out OUT", 1, "--policy foresight"},
    {"export", 2, "--student bess-train export --help"},
    {"report", 2, "--run bess-train report --help"},
    {"runs compare", 2, "bess-train runs compare --help"},
    {"prices fetch", 2, "bess-train prices fetch --help"},
    {"prices simulate", 2, "bess-train prices simulate --help"},
    {"prices import", 2, "bess-train prices import --help"},
    {"prices reconstruct", 2, "bess-train prices reconstruct --help"},
    {"prices stats", 2, "bess-train prices stats --help"},
    {"sweep task NONE", 2, "bess-train sweep task --help"},
    {"sweep task NONE 1", 1, "NONE bess-train sweep plan"},
    {"sweep packages", 2, "bess-train sweep packages --help"},
    {"sweep packages NONE --out OUT --arch mips", 2, "--arch mips armhf"},
    {"sweep packages NONE --out OUT --source NONE", 1, "NONE tools/package --source"},
    {"tarin", 2, "\"tarin\" train bess-train --help"},
    {"prices ftech", 2, "fetch bess-train prices --help"},
    {"prices statistics", 2, "\"statistics\""},
    {"run train --out OUT", 2, "\"train\" bess-train run --help"},
    {"--prices GOOD run --out OUT", 2, "--prices"},
    // Options.
    {"run --ouput OUT", 2, "--ouput --out bess-train run"},
    {"run --out OUT --plutonium", 2, "--plutonium bess-train run --help"},
    {"run --out", 2, "--out"},
    {"evaluate --prices GOOD --polcy rbc", 2, "--policy"},
    {"verify --studnet STUDENT", 2, "--student"},
    {"prices stats GOOD EMPTY", 2, "EMPTY bess-train prices stats --help"},
    {"verify --student STUDENT --student STUDENT", 2, "--student 2"},
    {"evaluate --prices GOOD --policy rbc --accept gaps --accept frozen", 2, "--accept 2"},
    // Numbers.
    {"run --out OUT --seed -1", 2, "--seed"},
    {"run --out OUT --seed 99999999999999999999", 2, "--seed 99999999999999999999"},
    {"run --out OUT --seed ''", 2, "--seed"},
    {"run --out OUT --threads 0", 2, "--threads"},
    {"run --out OUT --threads 257", 2, "--threads"},
    {"run --out OUT --delay 6", 2, "--delay"},
    {"run --out OUT --initial-soc 1.5", 1, "--initial-soc 1.5"},
    {"run --out OUT --initial-soc nan", 1, "--initial-soc nan"},
    {"run --out OUT --settlement hour", 2, "--settlement hour minute step"},
    {"run --out OUT --accept everything", 2, "--accept \"everything\" gaps"},
    {"train --prices GOOD --out OUT --method ppo", 2, "--method ppo sdp"},
    {"train --prices GOOD --out OUT --steps 0", 2, "--steps"},
    {"distil --prices GOOD --teacher NONE --out OUT --epochs 0", 2, "--epochs"},
    {"evaluate --prices GOOD --policy rbc --split tests", 2, "--split tests test"},
    {"evaluate --prices GOOD --policy rbc --fit-delay 9", 2, "--fit-delay"},
    {"evaluate --prices GOOD --policy rbc --date 2023-13-01", 1, "--date 2023-13-01"},
    {"evaluate --prices GOOD --policy rbc --date tomorrow", 1, "--date tomorrow YYYY-MM-DD widest"},
    {"evaluate --prices GOOD --policy rbc:9:1", 1, "rbc:LOW:HIGH"},
    {"evaluate --prices GOOD --policy rcb", 1, "--policy rcb"},
    {"evaluate --prices GOOD --policy ''", 2, "--policy"},
    {"evaluate --prices GOOD --policy GARBAGE", 1, "GARBAGE"},
    {"backtest --prices GOOD --out OUT --window-days 0", 2, "--window-days"},
    {"prices simulate --out OUT --start 2023-02-30", 1, "2023-02-30"},
    {"prices fetch --from 2023-01-32 --to 2023-02-01 --out OUT", 1, "2023-01-32"},
    {"prices fetch --from 2023-02-01 --to 2023-01-01 --out OUT", 1, "--to"},
    {"prices fetch --from 2023-01-01 --to 2023-01-02 --out OUT --base-url elia.be", 1,
     "--base-url elia.be"},
    // Files.
    {"run --out OUT --prices NONE", 1, "NONE"},
    {"run --out OUT --prices FOLDER", 1, "FOLDER"},
    {"run --out OUT --prices GARBAGE", 1, "GARBAGE"},
    {"run --out OUT --config NONE", 1, "NONE"},
    {"run --out OUT --config GARBAGE", 1, "GARBAGE:1"},
    {"run --out OUT --from-teacher NONE", 1, "NONE"},
    {"run --out OUT --prices GOOD --from-teacher GARBAGE", 1, "GARBAGE"},
    {"run --out EMPTY", 1, "EMPTY"},
    {"run --out -", 1, "./-"},
    {"run --out ''", 2, "--out"},
    {"run --out /proc/nowhere", 1, "/proc/nowhere"},
    {"report --run FOLDER", 1, "FOLDER run.json"},
    {"train --prices GOOD --out FOLDER", 1, "FOLDER"},
    {"distil --prices GOOD --teacher GARBAGE --out OUT", 1, "GARBAGE"},
    {"distil --prices GOOD --teacher STUDENT --out OUT", 1, "STUDENT"},
    {"evaluate --prices GOOD --policy rbc --csv -", 1, "./-"},
    {"evaluate --prices GOOD --policy rbc --csv FOLDER", 1, "FOLDER"},
    {"verify --student GARBAGE", 1, "GARBAGE"},
    {"export --student NONE --out OUT", 1, "NONE"},
    {"export --student GARBAGE --out OUT", 1, "GARBAGE"},
    {"export --student STUDENT --out FOLDER", 1, "FOLDER"},
    {"prices simulate --out FOLDER", 1, "FOLDER"},
    {"prices import GARBAGE --out OUT", 1, "GARBAGE"},
    {"prices import GOOD --out FOLDER", 1, "FOLDER"},
    {"prices reconstruct --quarter-hours NONE --out OUT", 1, "NONE"},
};

class BadTrainCommandLine : public testing::Test {
 protected:
  BadTrainCommandLine() {
    write_minute_file(folder_.file("GOOD"), small_series(31), "");
    save_student(folder_.file("STUDENT"), compiled_student());
    files_["EMPTY"] = folder_.write("EMPTY", "");
    files_["GARBAGE"] = folder_.write("GARBAGE", "\x7f ELF, or something \x01\x02 like that\n");
    std::filesystem::create_directory(folder_.file("FOLDER"));
    for (const char* name : {"GOOD", "STUDENT", "NONE", "FOLDER", "OUT"}) {
      files_[name] = folder_.file(name);
    }
  }
  TemporaryFolder folder_;
  std::map<std::string, std::string> files_;
};

TEST_F(BadTrainCommandLine, EachIsRefusedInOneLineAndNothingIsWritten) {
  for (const BadCommandLine& line : kCases) {
    expect_refused(BESS_TRAIN_PROGRAM, line, files_);
    EXPECT_FALSE(std::filesystem::exists(folder_.file("OUT"))) << line.words;
    std::filesystem::remove_all(folder_.file("OUT"));
  }
}

TEST_F(BadTrainCommandLine, ABareCommandShowsItsHelp) {
  const CommandResult bare = run_train({"prices", "fetch"});
  EXPECT_THAT(bare.output, Names("bess-train prices fetch --allow-gaps"));
  EXPECT_EQ(bare.exit_code, 2);
}

TEST_F(BadTrainCommandLine, TheVersionShowsCommitCompilerAndInstructions) {
  const CommandResult version = run_train({"--version"});
  EXPECT_THAT(version.output, testing::MatchesRegex(
                                  "bess-train [0-9.]+\ncommit [-0-9a-z]+, (g\\+\\+|clang) [0-9].*, "
                                  "(x86-64|aarch64|arm).*\n"));
  EXPECT_EQ(version.exit_code, 0);
}

// Exit codes of bess-train, as scripts use them.

TEST(Program, OutputThatCannotBeWrittenIsAnError) {
  if (!std::filesystem::is_character_file("/dev/full")) {
    GTEST_SKIP() << "needs /dev/full, which is absent";
  }
  ChildProcess program({"/bin/sh", "-c", BESS_TRAIN_PROGRAM " config > /dev/full"});
  EXPECT_THAT(program.read_all(), Names(std::string("bess-train ") + std::strerror(ENOSPC)));
  EXPECT_EQ(program.wait(), 1);
}

TEST(Program, AByteOrderMarkBeforeTheConfigurationIsSkipped) {
  const TemporaryFolder folder;
  const std::string config = folder.write("run.toml", "\xEF\xBB\xBF[train]\nsteps = 7\n");
  const CommandResult result = run_train({"config", "--config", config});
  EXPECT_THAT(result.output, testing::HasSubstr("steps = 7 "));
  EXPECT_EQ(result.exit_code, 0);
}

TEST(Program, CtrlCEndsACommandThatHasNothingToSave) {
  const TemporaryFolder folder;
  const auto out = folder.file("market.csv.gz");
  ChildProcess program({BESS_TRAIN_PROGRAM, "prices", "simulate", "--days", "7000", "--out", out});
  ASSERT_TRUE(catches(program.pid(), SIGINT));  // far too soon for 7,000 days
  program.signal(SIGINT);
  EXPECT_EQ(program.wait(), 3);
  EXPECT_FALSE(std::filesystem::exists(out));
}

// Every command that writes a file refuses to overwrite its input, before it reads it.

TEST(OutputIsInput, IsRefusedAndTheFileStays) {
  const struct {
    const char* line;   ///< IN is the file that is read, OUT another name of it
    const char* names;  ///< options that the error names
  } cases[] = {
      {"train --prices IN --out OUT", "--out --prices"},
      {"train --prices IN --out FOLDER/t.bin --curve-out OUT", "--curve-out --prices"},
      {"distil --prices IN --teacher FOLDER/none --out OUT", "--out --prices"},
      {"distil --prices FOLDER/none --teacher IN --out OUT", "--out --teacher"},
      {"evaluate --prices IN --policy rbc --csv OUT", "--csv --prices"},
      {"evaluate --prices IN --policy rbc --days-out OUT", "--days-out --prices"},
      {"evaluate --prices FOLDER/none --fit IN --policy rbc --steps-out OUT", "--steps-out --fit"},
      {"evaluate --prices FOLDER/none --policy IN --csv OUT", "--csv --policy"},
      {"prices import IN --out OUT", "--out"},
      {"prices reconstruct --quarter-hours IN --out OUT", "--out --quarter-hours"},
      {"export --student IN --out OUT", "--out --student"},
      {"backtest --prices IN --out FOLDER", "--out --prices"},
      {"run --prices OUT --out FOLDER", "--out --prices"},
      {"run --config OUT --out FOLDER", "--out --config"},
      {"run --from-teacher OUT --out FOLDER", "--out --from-teacher"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(c.line);
    const TemporaryFolder folder;
    // Outputs of a run and a backtest have fixed names: the input is one of them.
    const std::string in = folder.write("backtest.csv", "precious");
    const std::string link = folder.file("report.html");
    std::filesystem::create_symlink(in, link);
    std::string line = c.line;
    for (const auto& [what, value] :
         {std::pair("IN", in), std::pair("OUT", link), std::pair("FOLDER", folder.file("."))}) {
      const std::size_t at = line.find(what);
      if (at != line.npos) line.replace(at, std::string(what).size(), value);
    }
    CommandLine command_line("bess-train", "", "");
    ProgramCommand root = command_line.root();
    add_commands(root);
    EXPECT_THAT(refusal_of([&] { command_line.parse(line); }), Names(c.names));
    EXPECT_EQ(read_file(in), "precious");
    EXPECT_TRUE(std::filesystem::is_symlink(link));
  }
}

}  // namespace
}  // namespace bess
