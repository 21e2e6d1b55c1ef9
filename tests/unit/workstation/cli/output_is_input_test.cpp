// Every command that writes a file refuses to overwrite its input, before it reads it.
#include <gmock/gmock.h>

#include <filesystem>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/cli/commands.h"

namespace bess {
namespace {

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
