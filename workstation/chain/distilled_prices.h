// What rules cost once they are learnt: students distilled with them and without from the same
// teacher, seed by seed, and the days that both trade. `rules price` has the command line.
#pragma once

#include <string>
#include <vector>

#include "workstation/chain/run_config.h"
#include "workstation/env/evaluate.h"
#include "workstation/rl/teacher.h"

namespace bess {

/// All rules of a set, where one of them alone goes by its name.
inline constexpr const char* kAllTogether = "all together";

/// The same days, each from the configured SoC and chained.
struct BothWays {
  Evaluation reset, carried;
};

BothWays run_both_ways(Policy& policy, const std::vector<MarketDay>& days, const RunConfig& config,
                       const MarketSteps& market);

/// What is paired: the mean over seeds of what rules change. Money in EUR per day per MWh.
struct SeededDifference {
  double mean;
  double standard_error;           ///< over days, of the mean over seeds
  double standard_error_by_month;  ///< the same by months
  double spread;                   ///< standard deviation over seeds; NaN for one seed
};

/// `with[s]` against `without[s]`; the same days, one entry a seed.
SeededDifference seeded_difference(const std::vector<Evaluation>& with,
                                   const std::vector<Evaluation>& without);

struct DistilledPriceOptions {
  RuleSet rules;
  std::vector<MarketDay> days;
  std::string split;   ///< that they are of
  int seeds = 1;       ///< from that of the configuration on
  bool alone = false;  ///< each rule alone besides all together
  std::string keep;    ///< folder for the students, each by rule and seed; empty: none
  bool json = false;
};

/// Prints a row a rule, as soon as it is known. Throws UserError when a student was not proved,
/// once all are told.
void price_by_distilling(const DistilledPriceOptions& options, const Teacher& teacher,
                         const RunConfig& config, const MarketSteps& market);

}  // namespace bess
