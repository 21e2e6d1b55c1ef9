// The mean profit over two settings, all others folded, as a table whose cells are coloured: it can
// be read aloud, copied and printed.
#pragma once

#include <string>
#include <vector>

#include "workstation/sweep/collected.h"

namespace bess {

/// `down` may be empty: one row then. `what` is shown; `id` is the table's, once on a page.
std::string heat_map_html(const std::vector<FoldedSettings>& rows, const std::string& across,
                          const std::string& down, const std::string& what = "Mean profit",
                          const std::string& id = "map");

}  // namespace bess
