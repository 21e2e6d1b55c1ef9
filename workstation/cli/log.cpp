// bess-train log: what a controller's log says, against other policies, another student, the bill.
#include "workstation/cli/commands.h"

namespace bess {

void add_log_commands(ProgramCommand& app) {
  ProgramCommand log = app.subcommand(
      "log", "A controller's log: other policies, another student, a statement beside the bill");
  log.requires_subcommand();
  add_log_compare(log);
  add_log_replay(log);
  add_log_statement(log);
}

}  // namespace bess
