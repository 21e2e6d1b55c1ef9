// A model that was learnt for another battery, market or bill goes on deciding as it learnt to: whoever uses it is
// told. Known is what the run beside its file says of itself.
#pragma once

#include <filesystem>

#include "workstation/cli/run_record.h"

namespace bess {

/// "KEY is A there and B here; ..." for each key of `here` that the run of `model` had otherwise; empty without a
/// run, or when all are the same.
std::string learnt_otherwise(const std::filesystem::path& model, const Entries& here);

/// One line on stderr when there is something to tell.
void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here);

}  // namespace bess
