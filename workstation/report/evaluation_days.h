// Every day of every policy's evaluation as CSV, each number in the shortest form that reads back
// to it: tables and paired differences are made again from it, to the bit.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/report/comparison.h"

namespace bess {

/// Header `policy,date,profit_eur,cycles,switches,throughput_mwh,carry_soc,soc_end_frac,
/// soc_start_frac,charge_value_eur,charge_price_eur_per_mwh`; no price: the charge is not valued.
std::string evaluation_days_csv(const std::vector<NamedEvaluation>& evaluations);

/// Reads it back for the battery that was evaluated; policies keep their order. Throws UserError
/// naming `name` and the line.
std::vector<NamedEvaluation> parse_evaluation_days_csv(std::string_view text,
                                                       const std::string& name,
                                                       const BatteryParameters& battery);

}  // namespace bess
