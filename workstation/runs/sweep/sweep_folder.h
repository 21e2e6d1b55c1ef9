// Sweep folder: file names.
//
//   sweep.json      program, prices and kind of tasks
//   base.toml       configuration of all tasks
//   minutes.csv.gz  copy of the prices
//   rules/          rule files, by content
//   tasks.tsv       one task per line; only appended
//   sites.tsv       fleet members with their class
//   array.sbatch    Slurm script for one task
//   joblog          log of GNU parallel
//   tasks/000/000017        complete output of task 17
//   tasks/000/000017.part/  folders of running attempts
//   log/000017.txt          their log, until the task is complete
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace bess {

struct SweepFolder {
  std::filesystem::path path;

  [[nodiscard]] std::filesystem::path record() const { return path / "sweep.json"; }
  [[nodiscard]] std::filesystem::path base() const { return path / "base.toml"; }
  [[nodiscard]] std::filesystem::path prices() const { return path / "minutes.csv.gz"; }
  [[nodiscard]] std::filesystem::path rules(const std::string& stem) const {
    return path / "rules" / (stem + ".toml");
  }
  [[nodiscard]] std::filesystem::path tasks() const { return path / "tasks.tsv"; }
  [[nodiscard]] std::filesystem::path sites() const { return path / "sites.tsv"; }
  [[nodiscard]] std::filesystem::path array_script() const { return path / "array.sbatch"; }
  [[nodiscard]] std::filesystem::path joblog() const { return path / "joblog"; }
  /// At most a thousand per folder, for file system performance.
  [[nodiscard]] std::filesystem::path result(int task) const {
    return path / "tasks" / fmt::format("{:03}", task / 1000) / fmt::format("{:06}", task);
  }
  [[nodiscard]] std::filesystem::path parts(int task) const { return result(task) += ".part"; }
  [[nodiscard]] std::filesystem::path log(int task) const {
    return path / "log" / fmt::format("{:06}.txt", task);
  }
};

// Engines of a sweep: command of GNU parallel for this machine, and script and
// commands of a Slurm array. Other schedulers call `bess-train sweep task FOLDER NUMBER`.

/// Runs all tasks without a success in the joblog; `jobs` in parallel (default: one per core).
std::vector<std::string> parallel_command(const SweepFolder& folder, std::optional<int> jobs = {});

/// Words quoted for a shell.
std::string shell_line(const std::vector<std::string>& words);

std::string array_script(const SweepFolder& folder);
/// One command per line, for up to a thousand tasks each.
std::string sbatch_lines(const SweepFolder& folder, const std::vector<int>& tasks);

}  // namespace bess
