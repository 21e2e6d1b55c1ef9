// Engines that run a sweep's tasks: the command of GNU parallel, which works here, and the script
// and commands of a Slurm array. Any other engine calls `bess-train sweep task FOLDER INDEX`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "workstation/runs/sweep/sweep_folder.h"

namespace bess {

/// Runs every task but those that ended well by its joblog; `jobs` at once, or one a core.
std::vector<std::string> parallel_command(const SweepFolder& folder, std::optional<int> jobs = {});

/// As a shell reads them.
std::string shell_line(const std::vector<std::string>& words);

std::string array_script(const SweepFolder& folder);
/// A command a line, for a thousand numbers each.
std::string sbatch_lines(const SweepFolder& folder, const std::vector<int>& tasks);

}  // namespace bess
