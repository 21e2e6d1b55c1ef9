// Run folders made by hand, for the page of many runs: finished ones, one that failed, one that was
// stopped and one whose numbers were edited.
#pragma once

#include <filesystem>
#include <vector>

#include "workstation/report/comparison.h"

namespace bess {

/// Each run's student is one of `baselines` with its profits scaled. Names tell what each run is.
void write_many_runs(const std::filesystem::path& folder,
                     const std::vector<NamedEvaluation>& baselines);

}  // namespace bess
