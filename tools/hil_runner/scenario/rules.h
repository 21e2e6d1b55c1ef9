// What is judged of every scenario, in this order. A row is a rule: its name, by which a scenario
// may leave it out, what it says, and its function judge_NAME in ../judge.
#pragma once

namespace bess {

#define BESS_RULES(ROW)                                                                          \
  ROW(soc_window,                                                                                \
      "the SoC stays in the edge's window, but for one cycle where the device has no "           \
      "limit")                                                                                   \
  ROW(power_limit, "no order is larger than the rated power")                                    \
  ROW(fresh_price, "no power is ordered on a price that is older than the limit")                \
  ROW(thresholds,                                                                                \
      "beyond its price thresholds the battery charges or discharges, unless it is full "        \
      "or empty")                                                                                \
  ROW(decision, "each logged decision is the certified student's, recomputed")                   \
  ROW(inputs, "the price and the SoC that it was made on are the market's and the battery's")    \
  ROW(outlook,                                                                                   \
      "each break-even price is the plan's on the day-ahead prices published by then, "          \
      "recomputed")                                                                              \
  ROW(order, "what the log calls written is what the battery was commanded")                     \
  ROW(witness,                                                                                   \
      "with `witness = true`: what is ordered, shown and measured is what the maker's table "    \
      "makes of the bytes on the wire")                                                          \
  ROW(in_time, "an order reaches the battery in its own cycle, before its deadline")             \
  ROW(in_control, "with prices and link the battery follows an order, 0 W included")             \
  ROW(safe_state,                                                                                \
      "without link or process no power is ordered for longer than the device's timer")          \
  ROW(fed, "no order runs out while the edge lives")                                             \
  ROW(held, "before the battery is given back, 0 W is held as long as configured")               \
  ROW(released, "whoever ends the edge, no order is left")                                       \
  ROW(energy, "the battery's energy and its SoC agree within 0.1 %")                             \
  ROW(flash, "registers in flash memory are written no more often than the map allows in a day") \
  ROW(connection,                                                                                \
      "the battery leads the house's connection beyond no limit of the meter but in the "        \
      "minute in which the house changes, and no quarter-hour above its peak")

struct RuleInfo {
  const char* name;
  const char* text;
};

inline constexpr RuleInfo kRuleInfos[] = {
#define BESS_ROW(name, text) {#name, text},
    BESS_RULES(BESS_ROW)
#undef BESS_ROW
};

}  // namespace bess
