// bess-train sweep run: tasks on this machine, by GNU parallel, which replaces this process.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/sweep_plan.h"

namespace bess {
namespace {

struct SweepRunArguments {
  std::string folder;
  std::optional<int> jobs;
  bool again = false;
};

[[noreturn]] void become_parallel(const SweepRunArguments& options) {
  const SweepFolder folder{options.folder};
  load_own_sweep(folder);
  if (options.again) std::filesystem::remove(folder.joblog());
  // The exit code of parallel is the number of failed tasks, which would read as another error.
  const std::string line =
      "command -v parallel >/dev/null || "
      "{ echo \"bess-train: install GNU parallel (Debian package 'parallel')\" >&2; exit 1; }; " +
      shell_line(parallel_command(folder, options.jobs)) + " || exit 1";
  execlp("sh", "sh", "-c", line.c_str(), nullptr);
  fail("cannot run sh: {}", std::strerror(errno));
}

}  // namespace

void add_sweep_run(ProgramCommand& sweep) {
  auto options = std::make_shared<SweepRunArguments>();
  ProgramCommand command =
      sweep.subcommand("run", "run open tasks on this machine with GNU parallel");
  command.option("folder", options->folder, "folder of the sweep").value_name("DIR").required();
  command.option("--jobs", options->jobs, "parallel tasks, one core each (default: all cores)")
      .range(1, 1024);
  command.flag("--again", options->again, "check every task, also those marked done");
  command.footer(
      "Repeat the command to continue and to retry failed tasks.\n"
      "Example:\n  bess-train sweep run sweeps/first --jobs 4");
  command.runs([options] { become_parallel(*options); });
}

}  // namespace bess
