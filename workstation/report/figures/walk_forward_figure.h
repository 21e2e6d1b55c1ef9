// The walk-forward figure beside that of a run: what its chain would have earned had it been learnt
// anew before each month that it traded, so that it saw no later one (backtest/walk_forward.h).
#pragma once

#include <optional>
#include <string>

#include "shared/host/json.h"
#include "workstation/env/day_errors.h"

namespace bess {

/// Of the whole chain, SoC carried over; EUR per day per MWh of capacity.
struct WalkForwardFigure {
  double profit;
  DayErrors errors;
  std::string page;  ///< the backtest's, as a link from the run's folder
};

/// There is one, or there is none and why.
struct WalkForwardOfRun {
  std::optional<WalkForwardFigure> figure;
  std::string why_none;  ///< and how to make one
};

/// A sentence for people.
std::string walk_forward_text(const WalkForwardOfRun& walk_forward);
/// The same, escaped, with a link to the backtest's page.
std::string walk_forward_html(const WalkForwardOfRun& walk_forward);
Json walk_forward_json(const WalkForwardFigure& figure);

}  // namespace bess
