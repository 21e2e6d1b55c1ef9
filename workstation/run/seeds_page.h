// seeds.html: the same run from several seeds on one page, with what tells how sure it is: errors
// over days beside the spread over seeds, which days they are, the prices, the command, and each
// run's own page.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/run/run_summary.h"

namespace bess {

/// A seed whose student was not proved: there is no figure of it, but a page.
struct UnprovedSeed {
  std::string folder;  ///< its name beside the page
  std::string reason;
};

/// Writes seeds.html and its figure into `folder`. `runs` are finished ones in folders beside it,
/// of the same prices; not empty. Throws UserError without gnuplot.
void write_seeds_page(const std::filesystem::path& folder, const std::vector<RunSummary>& runs,
                      const std::vector<Band>& bands, const std::vector<UnprovedSeed>& unproved);

}  // namespace bess
