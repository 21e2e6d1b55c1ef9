// What the student does around the present: at this minute and in this context, the prices up to
// which it charges and from which it discharges, at every state of charge. Its own integers; it is
// proved to be monotone in the price, so that two prices tell all of a column.
#pragma once

#include <array>
#include <cstdint>

#include "edge/why/margins.h"
#include "shared/host/json.h"

namespace bess {

struct DecisionMap {
  struct Column {
    std::int32_t charge_up_to_centi = 0;  ///< EUR/MWh / 100
    std::int32_t discharge_from_centi = 0;
  };
  std::array<Column, kSocCount> columns{};  ///< by SoC, in steps of 0.5 %
};

/// At the minute and in the context of `at`, whose price and SoC do not matter.
DecisionMap make_decision_map(LatticeState at, const PriceThresholds& thresholds, Policy policy);

Json decision_map_json(const DecisionMap& map);

/// Of the cycle that `why --json` tells of; without columns where the student was not asked, or it
/// was another one than ours.
Json decision_map_of(JsonValue why);

}  // namespace bess
