// Where a price regime begins among the days that a picture shows.
#pragma once

#include <string>
#include <vector>

#include "shared/host/json.h"

namespace bess {

/// [place, what changed] of each boundary between two of `dates`, which are ascending.
Json regime_marks(const std::vector<std::string>& dates);

}  // namespace bess
