// The folder of a sweep: names, and nothing else. Every state of a task is a file or folder that
// was made by one rename or one exclusive creation, so that any number of programs on any number of
// machines may look at it and work in it at once.
//
//   sweep.json      which program, prices and kind of tasks
//   base.toml       what all tasks have in common
//   minutes.csv.gz  the prices, as they were given
//   rules/          rule files, by content
//   tasks.tsv       a task a line; more may be appended, none is changed
//   sites.tsv       which class of students each site belongs to
//   tasks/000/000017/       what task 17 came to, published by one rename
//   attempts/000017/WHO/    at work on it, or left behind; WHO.ended: ended on purpose
//   failures/000017/WHO     why an attempt came to nothing
//   different/000017.WHO/   a second copy that came to something else, or half of one
//   submissions/3.tsv       what was sent to Slurm at once, an element of the array a line
//   log/                    what tasks said
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
  [[nodiscard]] std::filesystem::path results() const { return path / "tasks"; }
  /// A thousand to a folder: no file system likes ten thousand.
  [[nodiscard]] std::filesystem::path result(int task) const {
    return results() / fmt::format("{:03}", task / 1000) / number_text(task);
  }
  [[nodiscard]] std::filesystem::path attempts(int task) const {
    return path / "attempts" / number_text(task);
  }
  [[nodiscard]] std::filesystem::path failures(int task) const {
    return path / "failures" / number_text(task);
  }
  [[nodiscard]] std::filesystem::path different() const { return path / "different"; }
  [[nodiscard]] std::filesystem::path submissions() const { return path / "submissions"; }
  [[nodiscard]] std::filesystem::path log() const { return path / "log"; }

  static std::string number_text(int task) { return fmt::format("{:06}", task); }
};

}  // namespace bess
