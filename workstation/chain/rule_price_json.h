// What a rule costs or earns, as `rules price --json` tells it: the same keys, whichever way it was
// found.
#pragma once

#include <cmath>
#include <cstdint>
#include <optional>
#include <string>

#include "shared/host/json.h"

namespace bess {

/// In one way of counting; EUR per day per MWh, NaN where it is not known.
struct RuleGain {
  double profit = NAN;
  double without = NAN;  ///< the same without the rule
  double gain = NAN, gain_error = NAN, gain_error_by_month = NAN;
  double spread = NAN;  ///< standard deviation of the gain over seeds
};

struct RulePriceRow {
  std::string rule;
  const char* by;         ///< "projection" or "distillation"
  std::string gain_over;  ///< whose decisions are changed
  std::string split;
  std::size_t days;
  RuleGain reset, carried;
  double changed_share = NAN;  ///< of decisions, when projected
  std::optional<int> seeds{};  ///< and the rest when distilled
  std::optional<std::int64_t> states_checked{}, violations{};
  std::optional<std::size_t> proved{};  ///< of the seeds
  std::optional<std::size_t> rounds{};  ///< of the student that took most
  double seconds_per_student = NAN;     ///< to learn and prove one
};

Json rule_price_json(const RulePriceRow& row);

}  // namespace bess
