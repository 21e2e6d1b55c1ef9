// Program bess-train: from prices to a proved, exported student. Subcommands are in cli/.
//   exit 0 done   1 the input or its content is bad   2 the command line is bad
//        3 interrupted   130 by a second Ctrl-C
#include <csignal>

#include "shared/host/command_line.h"
#include "shared/host/embed/build_info.h"
#include "shared/local_time.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/chain/folder_lock.h"

int main(int argc, char** argv) {
  std::signal(SIGXFSZ, SIG_IGN);  // a file-size limit is reported like a full disk
  bess::set_market_time_zone();
  bess::CommandLine command_line("bess-train",
                                 "train, correct, prove and export a battery arbitrage policy",
                                 "bess-train " BESS_VERSION "\n" + bess::build_line());
  bess::ProgramCommand root = command_line.root();
  bess::add_commands(root);
  bess::end_when_interrupted();
  return command_line.run(argc, argv);
}
