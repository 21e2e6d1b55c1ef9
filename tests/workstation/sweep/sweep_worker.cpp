// A sweep whose tasks cost nothing: the machinery that publishes, counts, tries again and sends to
// Slurm, without the learning. For tests that kill it, and for what it costs.
//   sweep_worker task DIR NUMBER MS         writes three files, MS apart, and publishes them
//   sweep_worker run DIR COUNT JOBS MS      what is missing of COUNT tasks, JOBS at once
//   sweep_worker send DIR COUNT TASK_S OPTION...   what is missing, to Slurm as one array
//   sweep_worker sweep task --of DIR --submission N --element K    as Slurm calls it
//   sweep_worker check DIR COUNT            whether all are whole, and what came of them
//   sweep_worker page DIR COUNT             sweep.html and tasks.csv of so many made-up results
// On Slurm a task takes BESS_WORKER_MS.
#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <exception>
#include <filesystem>
#include <span>
#include <string>

#include "shared/crc32.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "workstation/base/random.h"
#include "workstation/chain/interruption.h"
#include "workstation/sweep/attempt.h"
#include "workstation/sweep/run_here.h"
#include "workstation/sweep/slurm.h"
#include "workstation/sweep/sweep_page.h"
#include "workstation/sweep/task_states.h"

namespace bess {
namespace {

constexpr const char* kFiles[] = {"student.json", "student_weights.h", "run.json"};

std::string text_of(const std::string& name, int task) {
  return name + " of " + std::to_string(task) + "\n";
}

TaskEnd do_task(const SweepFolder& folder, int task, int ms) {
  return attempt_task(folder, task, [&](const std::filesystem::path& at) {
    for (const char* name : kFiles) {
      usleep(1'000 * static_cast<unsigned>(ms));
      write_file(at / name, text_of(name, task));
    }
  });
}

RunHereResult run_all(const SweepFolder& folder, const std::vector<int>& tasks, int jobs, int ms) {
  const auto one = [&](int task) {
    if (do_task(folder, task, ms) == TaskEnd::kDifferent) fail("came to something else");
  };
  return run_here(folder, tasks, jobs, one, stdout);
}

int milliseconds_on_slurm() {
  const char* const text = std::getenv("BESS_WORKER_MS");
  return text == nullptr ? 0 : std::atoi(text);
}

int send(const SweepFolder& folder, int count, std::span<char*> rest) {
  Crc32 crc;
  crc.add_bytes(folder.path.c_str(), folder.path.string().size());
  SlurmRequest request;
  request.task_s = std::atof(rest[0]);
  request.options.assign(rest.begin() + 1, rest.end());
  const auto missing = missing_tasks(task_states(folder, count));
  const Submission sent = submit(folder, fmt::format("{:08x}", crc.value()), missing, request);
  fmt::print("sent {} in {} of {}, {} wait or run\n", sent.tasks, sent.elements, sent.chunk,
             sent.waiting);
  return 0;
}

/// Throws when a file of a result is not what it must be.
int check(const SweepFolder& folder, int count) {
  const auto states = task_states(folder, count);
  std::size_t failures = 0;
  for (int task = 1; task <= count; ++task) {
    failures += failures_of(folder, task).size();
    if (states[static_cast<std::size_t>(task - 1)] != TaskState::kProved) continue;
    for (const char* name : kFiles) {
      const auto path = folder.result(task) / name;
      if (read_file(path) != text_of(name, task)) fail("{}: is not whole", path.string());
    }
  }
  const SweepCounts counts = counts_of(folder, states);
  fmt::print("{} done, {} missing, {} failed, {} failures, {} different, {} left\n", counts.proved,
             counts.missing, counts.failed, failures, counts.different, counts.attempts);
  return 0;
}

/// Over two settings, every 50th not proved, failed or missing.
std::vector<CollectedTask> made_up(int count) {
  Random random(1);
  std::vector<CollectedTask> tasks;
  for (int t = 0; t < count; ++t) {
    const int fidelity = 1 + t % 10;
    const int rate = 1 + t / 10 % 10;
    CollectedTask task{{t + 1,
                        {{"seed", fmt::format("{}", 1 + t / 100)},
                         {"distil.fidelity", fmt::format("{}", fidelity)},
                         {"train.learning_rate", fmt::format("{}e-4", rate)}}},
                       t % 50 == 7 ? static_cast<TaskState>((t / 50) % 4) : TaskState::kProved,
                       {},
                       40};
    if (task.state == TaskState::kProved) {
      const double profit = 100 + 3.0 * fidelity - 7.0 * rate + 20 * random.uniform();
      task.figures = {profit,
                      2.5,
                      3.5,
                      profit - 90,
                      profit - 12,
                      profit - 4,
                      1 + random.uniform(),
                      0.8,
                      60,
                      fmt::format("{:08x}", 2'654'435'761U * static_cast<unsigned>(t + 1))};
    }
    tasks.push_back(task);
  }
  return tasks;
}

int write_page(const SweepFolder& folder, int count) {
  const std::vector<CollectedTask> tasks = made_up(count);
  const std::vector<CollectedSite> sites{
      {{"zürich-10", "ch", 4e6, 8e6, 0.5, "00ff"}, 3, 3, 91.25, 730, ""},
      {{"zürich-9", "ch", 4e3, 8e3, 0.5, "00ff"}, 3, 3, 91.25, 0.73, ""},
      {{"antwerp", "be", 1e3, 2e3, 0.5, "11ff"}, 3, 0, {}, {}, ""}};
  const SweepRecord record{"0123abcd", "bess-train", "prices", "market.csv.gz", "lean", 0};
  write_file(folder.path / "tasks.csv", tasks_csv(tasks));
  write_file(folder.path / "sweep.html", sweep_page(record, tasks, sites, {}));
  return 0;
}

int work(std::span<char*> words) {
  const std::string mode = words.size() > 2 ? words[0] : "";
  const SweepFolder folder{words.size() > 2 ? words[1] : ""};
  if (mode == "task" && words.size() == 4) {
    end_when_interrupted();
    return do_task(folder, std::atoi(words[2]), std::atoi(words[3])) == TaskEnd::kDifferent ? 1 : 0;
  }
  if (mode == "run" && words.size() == 5) {
    const auto missing = missing_tasks(task_states(folder, std::atoi(words[2])));
    return run_all(folder, missing, std::atoi(words[3]), std::atoi(words[4])).failed > 0 ? 1 : 0;
  }
  if (mode == "send" && words.size() >= 4) {
    return send(folder, std::atoi(words[2]), words.subspan(3));
  }
  if (mode == "check" && words.size() == 3) return check(folder, std::atoi(words[2]));
  if (mode == "page" && words.size() == 3) return write_page(folder, std::atoi(words[2]));
  if (mode == "sweep" && words.size() == 8) {
    const SweepFolder of{words[3]};
    const auto tasks = tasks_of_element(of, std::atoi(words[5]), std::atoi(words[7]));
    return run_all(of, tasks, 1, milliseconds_on_slurm()).failed > 0 ? 1 : 0;
  }
  fmt::print(stderr, "sweep_worker: see the head of its source for its modes\n");
  return 2;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  try {
    return bess::work({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    fmt::print(stderr, "sweep_worker: {}\n", error.what());
    return 1;
  }
}
