// Where a run's page comes from: when, where and by what it was made, and from which prices.
#pragma once

#include <string>
#include <vector>

#include "workstation/chain/run_config.h"
#include "workstation/env/market_steps.h"
#include "workstation/report/provenance.h"
#include "workstation/run/run_folder.h"

namespace bess {

/// When, where, by which command and how long; with SOURCE_DATE_EPOCH set the date alone.
std::vector<Fact> making_facts(const RunFolder& folder);
/// "bess-train 0.1.0, BUILD"
std::string program_text();

/// Reads run.json of `folder` for the prices and, where there is one, times.json for its stages'
/// times. With SOURCE_DATE_EPOCH in the environment (reproducible-builds.org) that is the date, and
/// what differs from one making to the next, host, command and times, is left out: the same run
/// gives the same bytes.
std::vector<Fact> run_facts(const RunConfig& config, const MarketSteps& market,
                            const RunFolder& folder);

}  // namespace bess
