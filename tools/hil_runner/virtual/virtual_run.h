// A scenario in virtual time: the edge's own loop, driver, link and guard against the simulated
// battery and market, as quick as the machine, the same to the byte every time.
#pragma once

#include <string>

#include "edge/settings/edge_config.h"
#include "shared/host/minute_file.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// The share of its power that the battery can give at an instant, by the weather; null: all of it.
using Weather = double (*)(std::int64_t utc_s);

Evidence run_virtual(const Scenario& scenario, const MinuteSeries& prices, const EdgeConfig& config,
                     Weather weather = nullptr);

}  // namespace bess
