// A model that was learnt for another battery, market, bill or price regime goes on deciding as it
// learnt to: whoever uses it is told. Its file says what it was learnt for; of a file that does
// not, the run beside it.
#pragma once

#include <filesystem>

#include "shared/host/minute_file.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

/// Market, battery and costs of `config`, and the prices: what a teacher is learnt for.
Entries learnt_for(const RunConfig& config, const MinuteSeries& series);
/// The same of what was learnt from a stretch of the prices alone: `days` of `market`, not empty.
Entries learnt_for(const RunConfig& config, const MinuteSeries& series, const MarketSteps& market,
                   const std::vector<MarketDay>& days);

/// What the model's file or the run beside it says; empty when neither does, and of what is no
/// file.
Entries learnt_for_of(const std::filesystem::path& model);

/// "KEY is A there and B here; ..." for each key of `here` that `there` has otherwise; empty when
/// all are the same.
std::string learnt_otherwise(const Entries& there, const Entries& here);

/// The price regimes of `days` of which nothing was learnt, in a sentence; empty when there is
/// none, or nothing is known.
std::string unknown_regimes(const Entries& there, const MarketSteps& market,
                            const std::vector<MarketDay>& days);

/// One line on stderr when `days` of `market` meet a price regime that no training or validation
/// day of `fitting` lies in.
void warn_unknown_regimes(const std::string& what, const MarketSteps& fitting,
                          const MarketSteps& market, const std::vector<MarketDay>& days);

/// One line for who trains on these prices at `now_utc_s`, when their newest day is old or lies in
/// another price regime, and how to get newer ones; else empty.
std::string old_prices(const MinuteSeries& series, std::int64_t now_utc_s);

/// One line on stderr when there is something to tell; of `days`, when they are given.
void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here,
                           const MarketSteps& market = {}, const std::vector<MarketDay>& days = {});

}  // namespace bess
