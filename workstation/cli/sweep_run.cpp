// bess-train sweep run: the tasks on this machine, by GNU parallel in this program's place.
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <memory>
#include <optional>

#include "shared/host/user_error.h"
#include "workstation/cli/commands.h"
#include "workstation/runs/sweep/engines.h"
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
  std::vector<std::string> words = parallel_command(folder, options.jobs);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  execvp(arguments[0], arguments.data());
  fail("GNU parallel cannot be run: {}; Debian has it as 'parallel'", std::strerror(errno));
}

}  // namespace

void add_sweep_run(ProgramCommand& sweep) {
  auto options = std::make_shared<SweepRunArguments>();
  ProgramCommand command =
      sweep.subcommand("run", "Run what is to be done on this machine, by GNU parallel");
  command.option("folder", options->folder, "Folder of the sweep").required();
  command.option("--jobs", options->jobs, "Tasks at once, one core each (default: all cores)")
      .range(1, 1024);
  command.flag("--again", options->again,
               "Look at every task, also at those that parallel knows as done");
  command.footer(
      "Called again, it goes on, and tries again what failed.\n"
      "Example:\n  bess-train sweep run sweeps/first --jobs 4");
  command.runs([options] { become_parallel(*options); });
}

}  // namespace bess
