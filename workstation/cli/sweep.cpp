// bess-train sweep: many runs, here or on a cluster.
#include "workstation/cli/commands.h"

namespace bess {

void add_sweep_commands(ProgramCommand& app) {
  ProgramCommand sweep = app.subcommand(
      "sweep", "Many runs, here or on a cluster: plan, run, task, collect, packages");
  sweep.requires_subcommand();
  add_sweep_plan(sweep);
  add_sweep_run(sweep);
  add_sweep_task(sweep);
  add_sweep_collect(sweep);
  add_sweep_packages(sweep);
}

}  // namespace bess
