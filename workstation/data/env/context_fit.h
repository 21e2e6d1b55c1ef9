// The context classes of a market [SPEC 4]: what the twelve values of the student's third input
// mean, fitted on training days.
#pragma once

#include <string>
#include <string_view>

#include "shared/context_classes.h"
#include "workstation/data/env/market_steps.h"
#include "workstation/data/env/outlook_book.h"

namespace bess {

/// "month", "level", "outlook"; throws UserError otherwise.
ContextKind parse_context(std::string_view name);

/// By level the classes are evenly wide and reach beyond the training days' levels on both sides:
/// another year lies elsewhere. Throws UserError when there are no training days.
ContextClasses fit_context_classes(const MarketSteps& market, ContextKind kind);

/// By outlook each class holds as many of the break-even prices that the training days have, at
/// SoCs of the whole window.
ContextClasses fit_outlook_classes(const MarketSteps& market, const OutlookBook& book);

/// The level that stands for a class, EUR/MWh: its middle; of the open ones as far out as their
/// neighbours'.
double class_level_eur_per_mwh(const ContextClasses& classes, int context_class);

/// For people, after a time of day: "in March", "at a price level from 84 to 96 EUR/MWh".
std::string context_text(const ContextClasses& classes, int context_class);

}  // namespace bess
