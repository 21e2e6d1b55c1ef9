// bess-hil: runs scenarios with the edge and judges them by the battery trace.
//   exit 0 all passed   1 one failed, or a file is bad   2 the command line is bad
#include "shared/local_time.h"
#include "tools/hil_runner/run/hil_command.h"

int main(int argc, char** argv) {
  bess::set_market_time_zone();
  bess::CommandLine command_line("bess-hil", "bess-hil: hardware-in-the-loop scenarios",
                                 BESS_VERSION);
  bess::ProgramCommand root = command_line.root();
  bess::add_run_command(root);
  return command_line.run(argc, argv);
}
