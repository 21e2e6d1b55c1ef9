// The sites of a sweep, and the classes that share a student. What a learning stage reads of a site
// is brought to one canonical size: its power becomes a C-rate at the capacity of the defaults, so
// that 4 MW / 8 MWh and 4 kW / 8 kWh, whose students would differ by a rounding of the last digit,
// are one class. Prices, seed, commit and instruction set are the same in a whole sweep.
//
// CSV, one line a site; only `id` must be there:
//   id,battery,contract,rules,thresholds,region,SECTION.KEY...
// battery, contract: configuration files, beside the CSV, with their [battery], [costs] or other
// keys; rules: rule files, a space between; thresholds: LOW:HIGH in EUR/MWh; a column named like a
// key holds its value. What is empty stays as in the sweep's configuration.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/chain/run_config.h"

namespace bess {

struct Site {
  std::string id;
  std::string region;
  double power_w = 0;
  double capacity_wh = 0;
  double initial_soc_frac = 0;
  std::string student;  ///< the class
};

/// What all sites of a class are learnt by.
struct SiteClass {
  std::string name;   ///< 16 hexadecimal digits of its key
  RunConfig config;   ///< at the canonical size
  std::string rules;  ///< as one file; empty: none
};

struct Sites {
  std::vector<Site> sites;
  std::vector<SiteClass> classes;  ///< in the order of their first site
};

/// FNV-1a, 64 bits: a name or a draw, not a proof; that two classes never share it is looked at.
std::uint64_t fnv1a(std::string_view text);

/// `config` at the canonical size. The C-rate is taken to twelve digits: 3300 W / 10000 Wh and 3.3
/// kW / 10 kWh are the same one. With a step it becomes the nearest of 1, 1 + step, (1 + step)^2...
/// and their reciprocals: at most half a step away.
RunConfig canonical(RunConfig config, double rate_step_percent = 0);

/// All that a learning stage reads of a configuration and of rules, a line each.
std::string learning_key(const RunConfig& config, const std::string& rules);

/// Throws UserError naming file, line and column.
Sites read_sites(const std::filesystem::path& csv, const RunConfig& base,
                 double rate_step_percent = 0);

/// A site a line, with its class; and back.
std::string format_sites(const std::vector<Site>& sites);
std::vector<Site> parse_sites(const std::string& text, const std::string& name);

}  // namespace bess
