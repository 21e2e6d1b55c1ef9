// The stages of a run, one row each: what it is called in run.json and times.json, what is told
// when it begins, and the files of the folder that it reads and writes. Resuming, progress, help,
// the list of a run's files and the table of the README go by these rows.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

struct Stage {
  std::string_view name;
  int number;                        ///< of those that are told
  const char* text;                  ///< empty: nothing is told, it goes with the one before
  std::vector<std::string> inputs;   ///< whose marks it is kept by
  std::vector<std::string> outputs;  ///< at most; figures and their tables not named
};

namespace stage_name {
inline constexpr std::string_view kConfiguration = "configuration";
inline constexpr std::string_view kPrices = "prices";
inline constexpr std::string_view kTeacher = "teacher";
inline constexpr std::string_view kPlain = "plain student";
inline constexpr std::string_view kCorrected = "corrected student";
inline constexpr std::string_view kHeader = "header";
inline constexpr std::string_view kEvaluation = "evaluation";
inline constexpr std::string_view kReport = "report";
inline constexpr std::string_view kFailureReport = "report of the failed proof";
}  // namespace stage_name

/// In order.
std::span<const Stage> run_stages();
/// Precondition: there is one of this name.
const Stage& stage_named(std::string_view name);
/// The number of the last.
int stage_count();

/// All that a run writes, but for the figures.
std::vector<std::string> run_files();

/// A line a stage: its number, its name and what it writes.
std::string stages_help();

}  // namespace bess
