// Names and values in order: what a run is made of, what a model was learnt for.
#pragma once

#include <string>
#include <utility>
#include <vector>

namespace bess {

using Entries = std::vector<std::pair<std::string, std::string>>;

}  // namespace bess
