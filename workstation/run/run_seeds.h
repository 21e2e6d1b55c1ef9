// The same run from several seeds, each in a folder of its own, and how far they are apart.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "workstation/run/run_summary.h"
#include "workstation/run/seeds_page.h"

namespace bess {

/// "DIR/seed-7"
std::filesystem::path seed_folder(const std::filesystem::path& folder, std::uint64_t seed);

/// Bands as aligned columns, for the terminal.
std::string format_bands(const std::vector<Band>& bands, std::size_t runs);
/// The same as one JSON object.
std::string bands_json(const std::vector<Band>& bands, std::size_t runs);

/// Writes seeds.csv and seeds.html, bands and every run, into `folder`.
void write_seeds_report(const std::filesystem::path& folder, const std::vector<RunSummary>& runs,
                        const std::vector<UnprovedSeed>& unproved = {});

}  // namespace bess
