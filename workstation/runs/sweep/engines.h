// Engines of a sweep: command of GNU parallel for this machine, and script and commands of a Slurm
// array. Other schedulers call `bess-train sweep task FOLDER NUMBER`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/runs/sweep/sweep_folder.h"

namespace bess {

/// Runs all tasks without a success in the joblog; `jobs` in parallel (default: one per core).
std::vector<std::string> parallel_command(const SweepFolder& folder, std::optional<int> jobs = {});

/// Words quoted for a shell.
std::string shell_line(const std::vector<std::string>& words);

std::string array_script(const SweepFolder& folder);
/// One command per line, for up to a thousand tasks each.
std::string sbatch_lines(const SweepFolder& folder, const std::vector<int>& tasks);

}  // namespace bess
