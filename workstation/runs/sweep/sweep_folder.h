// The folder of a sweep: names, and nothing else.
//
//   sweep.json      which program, prices and kind of tasks
//   base.toml       what all tasks have in common
//   minutes.csv.gz  the prices, as they were given
//   rules/          rule files, by content
//   tasks.tsv       a task a line; more may be appended, none is changed
//   sites.tsv       which class of students each site belongs to
//   array.sbatch    runs one task on Slurm
//   joblog          what GNU parallel ran
//   tasks/000/000017        the output of task 17, complete from the moment it has this name
//   tasks/000/000017.part/  folders of those who work on it
//   log/000017.txt          what they said, until it is complete
#pragma once

#include <fmt/format.h>

#include <filesystem>
#include <string>

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
  /// A thousand to a folder: no file system likes ten thousand.
  [[nodiscard]] std::filesystem::path result(int task) const {
    return path / "tasks" / fmt::format("{:03}", task / 1000) / fmt::format("{:06}", task);
  }
  [[nodiscard]] std::filesystem::path parts(int task) const { return result(task) += ".part"; }
  [[nodiscard]] std::filesystem::path log(int task) const {
    return path / "log" / fmt::format("{:06}.txt", task);
  }
};

}  // namespace bess
