#include <unistd.h>

#include <map>

#include "shared/host/run_program.h"
#include "workstation/runs/sweep/sweep_folder.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr int kArrayMax = 1'000;  // Slurm's default MaxArraySize is 1001

std::string task_command(const SweepFolder& folder) {
  return shell_line({fs::read_symlink("/proc/self/exe").string(), "sweep", "task",
                     fs::absolute(folder.path).lexically_normal().string()});
}

/// "1-4,9"
std::string ranges_text(const std::vector<int>& numbers) {
  std::string text;
  for (std::size_t i = 0; i < numbers.size();) {
    std::size_t end = i + 1;
    while (end < numbers.size() && numbers[end] == numbers[end - 1] + 1) ++end;
    text += fmt::format("{}{}", text.empty() ? "" : ",", numbers[i]);
    if (end - i > 1) text += fmt::format("-{}", numbers[end - 1]);
    i = end;
  }
  return text;
}

}  // namespace

std::vector<std::string> parallel_command(const SweepFolder& folder, std::optional<int> jobs) {
  std::vector<std::string> words{"parallel",        "--joblog", folder.joblog().string(),
                                 "--resume-failed", "--colsep", "\\t"};
  if (isatty(STDERR_FILENO) != 0) words.emplace_back("--eta");
  if (jobs) words.insert(words.end(), {"--jobs", std::to_string(*jobs)});
  words.insert(words.end(), {task_command(folder) + " {1}", "::::", folder.tasks().string()});
  return words;
}

std::string shell_line(const std::vector<std::string>& words) {
  std::string line;
  for (const std::string& word : words) line += (line.empty() ? "" : " ") + shell_word(word);
  return line;
}

std::string array_script(const SweepFolder& folder) {
  return fmt::format(
      "#!/bin/sh\n"
      "# sbatch --array=FIRST-LAST array.sbatch [OFFSET]: tasks OFFSET + FIRST to OFFSET + LAST\n"
      "#SBATCH --job-name=bess-sweep\n#SBATCH --ntasks=1\n#SBATCH --cpus-per-task=1\n"
      "#SBATCH --requeue\n#SBATCH --open-mode=append\n#SBATCH --output=\"{}\"\n"
      "exec {} $((SLURM_ARRAY_TASK_ID + ${{1:-0}}))\n",
      (fs::absolute(folder.path) / "log" / "slurm.txt").lexically_normal().string(),
      task_command(folder));
}

std::string sbatch_lines(const SweepFolder& folder, const std::vector<int>& tasks) {
  std::map<int, std::vector<int>> indices;  // by offset
  for (const int task : tasks) {
    const int offset = (task - 1) / kArrayMax * kArrayMax;
    indices[offset].push_back(task - offset);
  }
  std::string text;
  for (const auto& [offset, numbers] : indices) {
    text += fmt::format("sbatch --array={} {}{}\n", ranges_text(numbers),
                        shell_line({folder.array_script().string()}),
                        offset > 0 ? fmt::format(" {}", offset) : "");
  }
  return text;
}

}  // namespace bess
