// The sites of a sweep, and the classes that share a student (chain/learning_class.h). Prices,
// seed, commit and instruction set are the same in a whole sweep.
//
// CSV, one line a site; only `id` must be there:
//   id,battery,contract,rules,region,SECTION.KEY...
// battery, contract: configuration files, beside the CSV, with their [battery], [costs] or other
// keys; rules: rule files, a space between; a column named like a key holds its value. What is
// empty stays as in the sweep's configuration.
#pragma once

#include <filesystem>
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

/// Throws UserError naming file, line and column.
Sites read_sites(const std::filesystem::path& csv, const RunConfig& base,
                 double rate_step_percent = 0);

/// A site a line, with its class; and back.
std::string format_sites(const std::vector<Site>& sites);
std::vector<Site> parse_sites(const std::string& text, const std::string& name);

}  // namespace bess
