// Judged rules, one row each, in this order: name, by which a scenario can exclude it, and text.
// The function is judge_NAME in ../judge.
#pragma once

namespace bess {

#define BESS_RULES(ROW)                                                                          \
  ROW(soc_window,                                                                                \
      "the SoC stays in the edge's window, or within one control cycle of it where the device "  \
      "has no limit")                                                                            \
  ROW(power_limit, "no order exceeds the rated power")                                           \
  ROW(fresh_price, "no power is ordered on a price older than the limit")                        \
  ROW(thresholds,                                                                                \
      "beyond the price thresholds the battery charges or discharges, unless full or empty")     \
  ROW(decision, "each logged decision is that of the certified student, recomputed")             \
  ROW(inputs, "price and SoC of a decision are those of the market and the battery")             \
  ROW(outlook,                                                                                   \
      "each break-even price is that of the plan on the published day-ahead prices, recomputed") \
  ROW(order, "the battery was commanded what the log calls written")                             \
  ROW(witness,                                                                                   \
      "with `witness = true`: orders, displays and measurements match the bytes on the wire, "   \
      "decoded with the manufacturer's table")                                                   \
  ROW(in_time, "an order reaches the battery in its own control cycle, before the deadline")     \
  ROW(in_control, "with prices and link the battery follows an order, 0 W included")             \
  ROW(safe_state,                                                                                \
      "without link or process no power is ordered for longer than the device's timer")          \
  ROW(fed, "no order expires while the edge runs")                                               \
  ROW(held, "0 W is ordered for the configured time before a release")                           \
  ROW(released, "no order remains when the edge has ended, whatever the cause")                  \
  ROW(energy, "energy and SoC of the battery agree within 0.1 %")                                \
  ROW(flash, "flash registers are not written more often than the map allows per day")           \
  ROW(connection,                                                                                \
      "the battery violates no limit at the connection, except in the minute of a load change, " \
      "and no quarter-hour peak")

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
