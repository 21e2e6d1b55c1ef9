// A sweep whose tasks cost nothing: the machinery that publishes, counts and tries again, without
// the learning. For tests that kill it.
//   sweep_worker task DIR NUMBER MS        writes three files, MS apart, and publishes them
//   sweep_worker run DIR COUNT JOBS MS     what is missing of COUNT tasks, JOBS at once
#include <unistd.h>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <string>

#include "shared/host/file.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/run_here.h"
#include "workstation/sweep/task_states.h"

namespace {

int do_task(const bess::SweepFolder& folder, int task, const std::string& ms) {
  const auto work = [&](const std::filesystem::path& at) {
    for (const char* name : {"student.json", "student_weights.h", "run.json"}) {
      usleep(1'000 * static_cast<unsigned>(std::stoi(ms)));
      bess::write_file(at / name, std::string(name) + " of " + std::to_string(task) + "\n");
    }
  };
  return bess::attempt_task(folder, task, work) == bess::TaskEnd::kDifferent ? 1 : 0;
}

int do_run(const bess::SweepFolder& folder, int count, int jobs, const std::string& ms) {
  const std::string self = std::filesystem::read_symlink("/proc/self/exe").string();
  const auto missing = bess::missing_tasks(bess::task_states(folder, count));
  const auto result =
      bess::run_here(folder, missing, jobs, {self, "task", folder.path.string(), "{}", ms}, stdout);
  return result.failed > 0 ? 1 : 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const std::string mode = argc > 1 ? argv[1] : "";
    if (mode == "task" && argc == 5) return do_task({argv[2]}, std::atoi(argv[3]), argv[4]);
    if (mode == "run" && argc == 6) {
      return do_run({argv[2]}, std::atoi(argv[3]), std::atoi(argv[4]), argv[5]);
    }
    std::fprintf(stderr, "sweep_worker: task DIR NUMBER MS, or run DIR COUNT JOBS MS\n");
    return 2;
  } catch (const std::exception& error) {
    std::fprintf(stderr, "sweep_worker: %s\n", error.what());
    return 1;
  }
}
