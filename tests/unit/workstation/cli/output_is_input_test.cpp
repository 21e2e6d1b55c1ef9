// Every command that writes a file refuses to write over one that it reads, before it reads it.
#include <gmock/gmock.h>

#include <filesystem>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "workstation/cli/commands.h"

namespace bess {
namespace {

struct Case {
  const char* name;
  const char* line;   ///< IN is the file that is read, OUT another name of it
  const char* names;  ///< options that the error names
};

class OutputIsInput : public testing::TestWithParam<Case> {};

TEST_P(OutputIsInput, IsRefusedAndTheFileStays) {
  const TemporaryFolder folder;
  // A run's and a backtest's outputs have names of their own: the input is one of them.
  const std::string in = folder.write("backtest.csv", "precious");
  const std::string link = folder.file("report.html");
  std::filesystem::create_symlink(in, link);
  std::string line = GetParam().line;
  const auto put = [&line](const std::string& what, const std::string& value) {
    for (std::size_t at = 0; (at = line.find(what)) != line.npos;)
      line.replace(at, what.size(), value);
  };
  put("IN", in);
  put("OUT", link);
  put("FOLDER", folder.file("."));
  CommandLine command_line("bess-train", "", "");
  ProgramCommand root = command_line.root();
  add_commands(root);
  EXPECT_THAT([&] { command_line.parse(line); },
              testing::ThrowsMessage<UserError>(Names(GetParam().names)));
  EXPECT_EQ(read_file(in), "precious");
  EXPECT_TRUE(std::filesystem::is_symlink(link));
}

constexpr Case kOutputCases[] = {
    {"train", "train --prices IN --out OUT", "--out --prices"},
    {"train_curve", "train --prices IN --out FOLDER/t.bin --curve-out OUT", "--curve-out --prices"},
    {"distil_prices", "distil --prices IN --teacher FOLDER/none --out OUT", "--out --prices"},
    {"distil_teacher", "distil --prices FOLDER/none --teacher IN --out OUT", "--out --teacher"},
    {"evaluate_csv", "evaluate --prices IN --policy rbc --csv OUT", "--csv --prices"},
    {"evaluate_days", "evaluate --prices IN --policy rbc --days-out OUT", "--days-out --prices"},
    {"evaluate_steps", "evaluate --prices FOLDER/none --fit IN --policy rbc --steps-out OUT",
     "--steps-out --fit"},
    {"evaluate_policy", "evaluate --prices FOLDER/none --policy IN --csv OUT", "--csv --policy"},
    {"import", "prices import IN --out OUT", "--out"},
    {"reconstruct", "prices reconstruct --quarter-hours IN --out OUT", "--out --quarter-hours"},
    {"export", "export --student IN --out OUT", "--out --student"},
    {"backtest", "backtest --prices IN --out FOLDER", "--out --prices"},
    {"run_prices", "run --prices OUT --out FOLDER", "--out --prices"},
    {"run_config", "run --config OUT --out FOLDER", "--out --config"},
    {"run_teacher", "run --from-teacher OUT --out FOLDER", "--out --from-teacher"},
};
INSTANTIATE_TEST_SUITE_P(Commands, OutputIsInput, testing::ValuesIn(kOutputCases),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace bess
