// Context classes of a market [SPEC 4]: meaning of the twelve values of the student's third input,
// fitted on training days.
#pragma once

#include <string>
#include <string_view>

#include "shared/context_classes.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/plan_cache.h"

namespace bess {

/// "month", "level", "outlook"; throws UserError otherwise.
ContextKind parse_context(std::string_view name);

/// Level: classes of equal width that extend beyond the training days' levels on both sides,
/// because other years have other levels. Throws UserError without training days.
ContextClasses fit_context_classes(const MarketSteps& market, ContextKind kind);

/// Outlook: each class has the same number of the training days' break-even prices, at SoCs of the
/// whole window.
ContextClasses fit_outlook_classes(const MarketSteps& market, const PlanCache& plan_cache);

/// Representative level of a class, EUR/MWh: its middle; for the open classes as far out as in
/// their neighbours.
double class_level_eur_per_mwh(const ContextClasses& classes, int context_class);

/// Readable, after a time of day: "in March", "at a price level from 84 to 96 EUR/MWh".
std::string context_text(const ContextClasses& classes, int context_class);

}  // namespace bess
