// Training scope of a model: battery, market, costs and price regime, with warnings when it is used
// outside it. Source: the model file, else the run in its folder.
#pragma once

#include <filesystem>

#include "shared/host/minute_file.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/runs/run/run_record.h"

namespace bess {

/// Training scope of a teacher: market, battery and costs of `config`, and prices_hash() of the
/// prices.
Entries learnt_for(const RunConfig& config, const std::string& prices);

/// Scope stored in the model file or the run in its folder; empty when unknown.
Entries learnt_for_of(const std::filesystem::path& model);

/// "KEY is A there and B here; ..." for each key of `here` with another value in `there`.
std::string learnt_otherwise(const Entries& there, const Entries& here);

/// Warning on stderr when `days` of `market` are in a price regime without training or validation
/// days in `fitting`.
void warn_unknown_regimes(const std::string& what, const MarketSteps& fitting,
                          const MarketSteps& market, const std::vector<MarketDay>& days);

/// Warning with remedy when the latest day of these prices is old at `now_utc_s` or in another
/// price regime; else empty.
std::string old_prices(const MinuteSeries& series, std::int64_t now_utc_s);

/// Warning on stderr when the scopes differ, or when `days` are in an unknown price regime.
void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here,
                           const MarketSteps& market = {}, const std::vector<MarketDay>& days = {});

}  // namespace bess
