// States in which a student violates a property, as CSV: where a report looks, without another
// proof.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/features.h"

namespace bess {

/// Header `minute_of_quarter_hour,quarter_hour,context_class,soc_index,price_eur_per_mwh`.
std::string counterexamples_csv(const std::vector<LatticeState>& states);
/// Reads it back; throws UserError naming `name` and the line.
std::vector<LatticeState> parse_counterexamples_csv(std::string_view text, const std::string& name);

}  // namespace bess
