// Evaluation days: their split and relation to training, and daily results as CSV with exact
// numbers, from which tables and paired differences can be recomputed.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/report/comparison.h"

namespace bess {

// Evaluation days of a result. Days 26 to the end of each month are held out, but training may
// include later months.

struct JudgedDays {
  Split split;
  std::vector<std::string> dates;  ///< ascending, "2023-01-31"
  std::string last_learnt;         ///< last training or validation day; empty: unknown

  [[nodiscard]] std::size_t before_last_learnt() const;  ///< number of evaluation days before it
  [[nodiscard]] std::size_t months() const;
};

/// Last training or validation day; empty without any.
std::string last_learnt_day(const MarketSteps& market);

JudgedDays judged_days(const MarketSteps& market, Split split);

/// Two sentences: split with its days, and relation to the training days.
std::string judged_days_text(const JudgedDays& judged);
Json judged_days_json(const JudgedDays& judged);

/// Header `policy,date,profit_eur,cycles,switches,throughput_mwh,carry_soc,soc_end_frac,
/// soc_start_frac,charge_value_eur,charge_price_eur_per_mwh`; no price: the final charge is not
/// valued.
std::string evaluation_days_csv(const std::vector<NamedEvaluation>& evaluations);

/// Reads it for the evaluated battery; policies keep their order. Throws UserError naming `name`
/// and the line.
std::vector<NamedEvaluation> parse_evaluation_days_csv(std::string_view text,
                                                       const std::string& name,
                                                       const BatteryParameters& battery);

}  // namespace bess
