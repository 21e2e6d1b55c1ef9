// The days an evaluation judges, and every day of every policy as CSV, each number in the shortest
// form that reads back exactly: tables and paired differences can be made again from it.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/report/comparison.h"

namespace bess {

// Which days a figure is about, and whether what is judged had learnt from later ones: days 26 to
// the end of each month are kept from learning, but the months after them are not.

struct JudgedDays {
  Split split;
  std::vector<std::string> dates;  ///< of the days, ascending, "2023-01-31"
  std::string last_learnt;         ///< the last day that was trained or chosen on; empty: not known

  [[nodiscard]] std::size_t before_last_learnt() const;  ///< how many of the days are
  [[nodiscard]] std::size_t months() const;
};

/// The last training or validation day; empty without any.
std::string last_learnt_day(const MarketSteps& market);

JudgedDays judged_days(const MarketSteps& market, Split split);

/// Two sentences for people: the rule of the split with the days' span, and what learning saw.
std::string judged_days_text(const JudgedDays& judged);
Json judged_days_json(const JudgedDays& judged);

/// Header `policy,date,profit_eur,cycles,switches,throughput_mwh,carry_soc,soc_end_frac,
/// soc_start_frac,charge_value_eur,charge_price_eur_per_mwh`; no price: the charge is not valued.
std::string evaluation_days_csv(const std::vector<NamedEvaluation>& evaluations);

/// Reads it back for the battery that was evaluated; policies keep their order. Throws UserError
/// naming `name` and the line.
std::vector<NamedEvaluation> parse_evaluation_days_csv(std::string_view text,
                                                       const std::string& name,
                                                       const BatteryParameters& battery);

}  // namespace bess
