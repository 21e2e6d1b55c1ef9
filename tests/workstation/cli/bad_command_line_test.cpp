// bess-train refuses what nobody can have meant: one clear line with the mend, exit code 2 for a
// bad command line and 1 for bad input, and nothing is written.
#include "tests/support/bad_command_lines.h"

#include <gtest/gtest.h>

#include <filesystem>

#include "shared/host/minute_file.h"
#include "tests/support/small_market.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/train_commands.h"
#include "workstation/student/student_file.h"

namespace bess {
namespace {

// GOOD is a minute file, STUDENT a student's, NONE nothing, FOLDER a folder, EMPTY and GARBAGE
// files, OUT what must not appear.
constexpr BadCommandLine kCases[] = {
    // Subcommands.
    {"", 2, "subcommand is required (see bess-train --help)"},
    {"prices", 2, "subcommand is required (see bess-train prices --help)"},
    {"runs", 2, "subcommand is required (see bess-train runs --help)"},
    {"run", 2, "--out is required (see bess-train run --help)"},
    {"train", 2, "is required (see bess-train train --help)"},
    {"distil", 2, "is required (see bess-train distil --help)"},
    {"evaluate", 2, "is required (see bess-train evaluate --help)"},
    {"backtest", 2, "is required (see bess-train backtest --help)"},
    {"size", 2, "is required (see bess-train size --help)"},
    {"impact", 2, "--out is required (see bess-train impact --help)"},
    {"impact --fleet-mw many --out OUT", 1, "--fleet-mw many: use megawatts from 0"},
    {"impact --fleet-mw -5 --out OUT", 1, "--fleet-mw -5: use megawatts from 0"},
    {"impact --policy foresight --out OUT", 1, "neither tomorrow's prices nor the day-ahead"},
    {"delays", 2, "is required (see bess-train delays --help)"},
    {"export", 2, "--student is required (see bess-train export --help)"},
    {"report", 2, "--run is required (see bess-train report --help)"},
    {"runs compare", 2, "is required (see bess-train runs compare --help)"},
    {"prices fetch", 2, "is required (see bess-train prices fetch --help)"},
    {"prices simulate", 2, "is required (see bess-train prices simulate --help)"},
    {"prices import", 2, "is required (see bess-train prices import --help)"},
    {"prices reconstruct", 2, "is required (see bess-train prices reconstruct --help)"},
    {"prices record", 2, "is required (see bess-train prices record --help)"},
    {"prices stats", 2, "is required (see bess-train prices stats --help)"},
    {"sweep task NONE", 2, "is required (see bess-train sweep task --help)"},
    {"sweep task NONE 1", 1, "holds no sweep; plan one with 'bess-train sweep plan"},
    {"sweep run NONE", 1, "holds no sweep; plan one with 'bess-train sweep plan"},
    {"sweep packages", 2, "is required (see bess-train sweep packages --help)"},
    {"sweep packages NONE --out OUT --arch mips", 2, "mips not in {"},
    {"sweep packages NONE --out OUT --source NONE", 1,
     "no tools/package there: packages are compiled from a checkout of the source; --source DIR"},
    {"tarin", 2, "unknown subcommand \"tarin\"; did you mean train? (see bess-train --help)"},
    {"Train", 2, "did you mean train?"},
    {"verfiy", 2, "did you mean verify?"},
    {"eval", 2, "did you mean evaluate?"},
    {"distill", 2, "did you mean distil?"},
    {"xyzzy", 2, "unknown subcommand \"xyzzy\" (see bess-train --help)"},
    {"prices ftech", 2, "did you mean fetch? (see bess-train prices --help)"},
    {"prices statistics", 2, "unknown subcommand \"statistics\""},
    {"runs compair NONE", 2, "did you mean compare? (see bess-train runs --help)"},
    {"run train --out OUT", 2, "\"train\" is one word too many (see bess-train run --help)"},
    {"--prices GOOD run --out OUT", 2, "unknown option --prices"},
    // Options.
    {"run --ouput OUT", 2, "unknown option --ouput; did you mean --out? (see bess-train run"},
    {"run --out OUT --resmue", 2, "unknown option --resmue; did you mean --resume?"},
    {"run --out OUT --from-techer NONE", 2, "did you mean --from-teacher?"},
    {"run --out OUT --sed 7", 2, "did you mean --seed?"},
    {"run --out OUT --price GOOD", 2, "did you mean --prices?"},
    {"run --out OUT --plutonium", 2, "unknown option --plutonium (see bess-train run --help)"},
    {"run --out OUT -x", 2, "unknown option -x"},
    {"run --out", 2, "--out"},
    {"run --out OUT extra", 2, "\"extra\" is one word too many"},
    {"train --prices GOOD --out OUT --methd sdp", 2, "did you mean --method?"},
    {"evaluate --prices GOOD --polcy rbc", 2, "did you mean --policy?"},
    {"verify --studnet STUDENT", 2, "did you mean --student?"},
    {"export --studnet STUDENT", 2, "did you mean --student?"},
    {"prices stats GOOD EMPTY", 2, "one word too many (see bess-train prices stats --help)"},
    {"prices fetch --form 2023-01-01 --to 2023-01-02 --out OUT", 2, "did you mean --from?"},
    {"config --confg NONE", 2, "did you mean --config?"},
    {"verify --student STUDENT --student STUDENT", 2, "--student: given 2 times; give it once"},
    {"evaluate --prices GOOD --policy rbc --accept gaps --accept frozen", 2,
     "--accept: given 2 times; give it once (a list with commas"},
    // Numbers.
    {"run --out OUT --seed -1", 2, "--seed"},
    {"run --out OUT --seed seven", 2, "--seed: seven is no number of the kind that is meant"},
    {"run --out OUT --seed 1.5", 2, "--seed: 1.5 is no number of the kind that is meant"},
    {"run --out OUT --seed 1e300", 2, "--seed"},
    {"run --out OUT --seed 99999999999999999999", 2, "is too large a number"},
    {"run --out OUT --threads 99999999999", 2, "--threads"},
    {"run --out OUT --seed ''", 2, "--seed: needs a value, not an empty text"},
    {"run --out OUT --threads 0", 2, "--threads: "},
    {"run --out OUT --threads 257", 2, "--threads: "},
    {"run --out OUT --threads -2", 2, "--threads: "},
    {"run --out OUT --threads many", 2, "--threads: "},
    {"run --out OUT --delay 6", 2, "--delay: "},
    {"run --out OUT --delay -1", 2, "--delay: "},
    {"run --out OUT --delay 0.5", 2, "--delay: "},
    {"run --out OUT --initial-soc 1.5", 1, "--initial-soc 1.5: use"},
    {"run --out OUT --initial-soc -0.1", 1, "--initial-soc -0.1: use"},
    {"run --out OUT --initial-soc nan", 1, "--initial-soc nan: use"},
    {"run --out OUT --initial-soc 1e300", 1, "--initial-soc 1e+300: use"},
    {"run --out OUT --initial-soc half", 2, "--initial-soc"},
    {"run --out OUT --settlement hour", 2, "hour not in {minute,step}"},
    {"run --out OUT --accept everything", 2, "no finding is called \"everything\""},
    {"train --prices GOOD --out OUT --method ppo", 2, "ppo not in {"},
    {"train --prices GOOD --out OUT --steps 0", 2, "--steps"},
    {"train --prices GOOD --out OUT --steps -5", 2, "--steps"},
    {"train --prices GOOD --out OUT --steps 1e9", 2, "--steps"},
    {"distil --prices GOOD --teacher NONE --out OUT --epochs 0", 2, "--epochs"},
    {"evaluate --prices GOOD --policy rbc --split tests", 2, "tests not in {"},
    {"evaluate --prices GOOD --policy rbc --fit-delay 9", 2, "--fit-delay: "},
    {"evaluate --prices GOOD --policy rbc --date 2023-13-01", 1, "no complete day of that date"},
    {"evaluate --prices GOOD --policy rbc --date tomorrow", 1, "use YYYY-MM-DD or widest"},
    {"evaluate --prices GOOD --policy rbc:5", 1, "use rbc:LOW:HIGH"},
    {"evaluate --prices GOOD --policy rbc:9:1", 1, "use rbc:LOW:HIGH"},
    {"evaluate --prices GOOD --policy rbc:a:b", 1, "use rbc:LOW:HIGH"},
    {"evaluate --prices GOOD --policy rbc:nan:nan", 1, "use rbc:LOW:HIGH"},
    {"evaluate --prices GOOD --policy rbc:1:1e999", 1, "use rbc:LOW:HIGH"},
    {"evaluate --prices GOOD --policy rcb", 1, "--policy rcb: neither a file nor one of"},
    {"evaluate --prices GOOD --policy ''", 2, "--policy: needs a value, not an empty text"},
    {"evaluate --prices GOOD --policy GARBAGE", 1, "GARBAGE"},
    {"evaluate --prices GOOD --policy FOLDER", 1, "FOLDER"},
    {"backtest --prices GOOD --out OUT --window-days 0", 2, "--window-days"},
    {"prices simulate --out OUT --days 0", 2, "--days"},
    {"prices simulate --out OUT --days -3", 2, "--days"},
    {"prices simulate --out OUT --days 1e6", 2, "--days"},
    {"prices simulate --out OUT --start 2023-02-30", 1, "2023-02-30"},
    {"prices simulate --out OUT --start yesterday", 1, "yesterday"},
    {"prices fetch --from 2023-01-32 --to 2023-02-01 --out OUT", 1, "2023-01-32"},
    {"prices fetch --from 1.1.2023 --to 2.1.2023 --out OUT", 1, "1.1.2023"},
    {"prices fetch --from 2023-02-01 --to 2023-01-01 --out OUT", 1, "--to"},
    {"prices fetch --from 2023-01-01 --to 2023-01-02 --out OUT --base-url elia.be", 1,
     "web address"},
    {"prices record --out OUT --poll-s 1", 2, "--poll-s"},
    {"prices record --out OUT --for soon", 1, "soon"},
    {"prices record --out OUT --until 24:00", 1, "24:00"},
    // Files.
    {"run --out OUT --prices NONE", 1, "NONE: there is no such minute file"},
    {"run --out OUT --prices FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"run --out OUT --prices EMPTY", 1, "EMPTY"},
    {"run --out OUT --prices GARBAGE", 1, "GARBAGE"},
    {"run --out OUT --config NONE", 1, "NONE: cannot open"},
    {"run --out OUT --config FOLDER", 1, "FOLDER: is a folder"},
    {"run --out OUT --config GARBAGE", 1, "GARBAGE:1: not valid TOML"},
    {"run --out OUT --from-teacher NONE", 1, "NONE: cannot be read"},
    {"run --out OUT --prices GOOD --from-teacher GARBAGE", 1, "GARBAGE"},
    {"run --out EMPTY", 1, "EMPTY"},
    {"run --out -", 1, "means the standard output elsewhere"},
    {"run --out ''", 2, "--out: needs a value, not an empty text"},
    {"run --out OUT --prices ''", 2, "--prices: needs a value, not an empty text"},
    {"run --out /proc/nowhere", 1, "/proc/nowhere"},
    {"run --resume --out OUT --prices NONE", 1, "NONE: there is no such minute file"},
    {"report --run NONE", 1, "NONE: holds no run"},
    {"report --run FOLDER", 1, "holds no run, there is no run.json in it"},
    {"runs compare NONE", 1, "NONE: holds no run"},
    {"runs compare FOLDER", 1, "holds no run"},
    {"train --prices NONE --out OUT", 1, "NONE: cannot open"},
    {"train --prices GOOD --out FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"train --prices GOOD --out -", 1, "means the standard output elsewhere"},
    {"train --prices GOOD --out /proc/nowhere/t.bin", 1, "/proc/nowhere: cannot create"},
    {"distil --prices GOOD --teacher NONE --out OUT", 1, "NONE"},
    {"distil --prices GOOD --teacher GARBAGE --out OUT", 1, "GARBAGE"},
    {"distil --prices GOOD --teacher STUDENT --out OUT", 1, "STUDENT"},
    {"distil --prices GOOD --teacher NONE --out -", 1, "means the standard output elsewhere"},
    {"evaluate --prices GOOD --policy rbc --csv -", 1, "means the standard output elsewhere"},
    {"evaluate --prices GOOD --policy rbc --csv FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"evaluate --prices GOOD --fit NONE --policy rbc", 1, "NONE: cannot open"},
    {"backtest --prices NONE --out OUT", 1, "NONE"},
    {"delays --prices NONE", 1, "NONE: cannot open"},
    {"verify --student NONE", 1, "NONE: cannot open"},
    {"verify --student GARBAGE", 1, "GARBAGE"},
    {"verify --student EMPTY", 1, "EMPTY"},
    {"verify --student FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"export --student NONE --out OUT", 1, "NONE: cannot open"},
    {"export --student GARBAGE --out OUT", 1, "GARBAGE"},
    {"export --student STUDENT --out FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"export --student STUDENT --out -", 1, "means the standard output elsewhere"},
    {"export --student STUDENT --out /proc/nowhere/w.h", 1, "/proc/nowhere: cannot create"},
    {"config --config NONE", 1, "NONE: cannot open"},
    {"prices simulate --out FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"prices simulate --out -", 1, "means the standard output elsewhere"},
    {"prices import NONE --out OUT", 1, "NONE"},
    {"prices import GARBAGE --out OUT", 1, "GARBAGE"},
    {"prices import GOOD --out FOLDER", 1, "FOLDER: is a folder, not a file"},
    {"prices reconstruct --quarter-hours NONE --out OUT", 1, "NONE"},
    {"prices stats NONE", 1, "NONE: cannot open"},
    {"prices record --out EMPTY", 1, "EMPTY"},
};

struct ConfigMistake {
  const char* text;
  const char* complaint;
};

// What stands in a configuration, read by `config --config FILE`.
constexpr ConfigMistake kConfigMistakes[] = {
    {"[trian]\nsteps = 1\n", "bad.toml:1: unknown section or key \"trian\"; did you mean train?"},
    {"steps = 1\n", "bad.toml:1: unknown section or key \"steps\""},
    {"[train]\nstep = 1\n", "bad.toml:2: unknown key \"step\" in [train]; did you mean steps?"},
    {"[train]\nlearning_rat = 1\n", "did you mean learning_rate?"},
    {"[battery]\ncapacity = 1\n", "did you mean capacity_wh?"},
    {"[battery]\nvolts = 48\n",
     "unknown key \"volts\" in [battery]; 'bess-train config' lists all"},
    {"[train]\nsteps = 0\n", "bad.toml:2: [train] steps: 0 is out of range"},
    {"[train]\nsteps = 1.5\n", "expected a whole number"},
    {"[train]\nsteps = \"many\"\n", "expected a whole number"},
    {"[train]\nmethod = \"ppo\"\n", "[train] method"},
    {"[train]\nmethod = 3\n", "[train] method"},
    {"[train]\ncontext = \"week\"\n", "[train] context"},
    {"[battery]\npower_w = nan\n", "[battery] power_w: nan is out of range"},
    {"[battery]\npower_w = inf\n", "[battery] power_w: inf is out of range"},
    {"[battery]\npower_w = 1e300\n", "[battery] power_w: 1e+300 is out of range"},
    {"[battery]\npower_w = -1\n", "out of range"},
    {"[battery]\npower_w = true\n", "expected a number"},
    {"[battery]\nsoc_min = 0.9\nsoc_max = 0.1\n", "soc_min must be below soc_max"},
    {"[battery]\ncold_power_share = 0.6\n", "set cold_from_hour and cold_to_hour"},
    {"[battery]\ncharge_efficiency = 1.1\n", "out of range"},
    {"[costs]\nimport_percent = 101\n", "out of range"},
    {"[costs]\nimport_percent = -1\n", "out of range"},
    {"[correction]\nlow_price_eur_per_mwh = 500\nhigh_price_eur_per_mwh = 100\n",
     "low_price_eur_per_mwh must be below high_price_eur_per_mwh"},
    {"[distil]\nepochs = -1\n", "out of range"},
    {"battery = 3\n", "\"battery\" is a section: write [battery]"},
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
  EXPECT_GE(std::size(kCases), 149u);
  for (const BadCommandLine& line : kCases) {
    expect_refused(BESS_TRAIN_PROGRAM, line, files_);
    EXPECT_FALSE(std::filesystem::exists(folder_.file("OUT"))) << line.words;
    std::filesystem::remove_all(folder_.file("OUT"));
  }
}

TEST_F(BadTrainCommandLine, SoIsEveryMistakeInAConfiguration) {
  for (const ConfigMistake& mistake : kConfigMistakes) {
    files_["CONFIG"] = folder_.write("bad.toml", mistake.text);
    SCOPED_TRACE(mistake.text);
    expect_refused(BESS_TRAIN_PROGRAM, {"config --config CONFIG", 1, mistake.complaint}, files_);
  }
}

TEST_F(BadTrainCommandLine, ABareCommandShowsItsHelp) {
  const CommandResult bare = run_train({"prices", "fetch"});
  EXPECT_THAT(bare.output, testing::HasSubstr("Usage: bess-train prices fetch"));
  EXPECT_THAT(bare.output, testing::HasSubstr("--allow-gaps"));
  EXPECT_EQ(bare.exit_code, 2);
}

TEST_F(BadTrainCommandLine, TheVersionTellsCommitCompilerAndInstructions) {
  const CommandResult version = run_train({"--version"});
  EXPECT_THAT(version.output, testing::MatchesRegex(
                                  "bess-train [0-9.]+\ncommit [-0-9a-z]+, (g\\+\\+|clang) [0-9].*, "
                                  "(x86-64|aarch64|arm).*\n"));
  EXPECT_EQ(version.exit_code, 0);
}

}  // namespace
}  // namespace bess
