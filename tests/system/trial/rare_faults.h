// Faults that the counts forgive, over days: at which ticks they strike, and what was moved wrongly
// by the time that they were found, in percent of the capacity.
#pragma once

#include <cstdio>
#include <string>

#include "tests/system/trial/trial_run.h"

namespace bess::trial {

struct Rhythm {
  const char* name;
  FaultTimes times;
};
inline constexpr Rhythm kRhythms[] = {{"every 2nd", {.every = 2}},
                                      {"every 3rd", {.every = 3}},
                                      {"every 4th", {.every = 4}},
                                      {"every 5th", {.every = 5}},
                                      {"every 6th", {.every = 6}},
                                      {"every 7th", {.every = 7}},
                                      {"every 8th", {.every = 8}},
                                      {"every 9th", {.every = 9}},
                                      {"every 10th", {.every = 10}},
                                      {"at random 0.05", {.probability = 0.05}},
                                      {"at random 0.1", {.probability = 0.1}},
                                      {"at random 0.2", {.probability = 0.2}},
                                      {"at random 0.3", {.probability = 0.3}}};
inline constexpr const char* kRareFaults[] = {"inverted", "inverted_charge", "inverted_discharge",
                                              "twice", "excess_2_kw"};
inline constexpr Orders kRareOrders[] = {Orders::kAlternating, Orders::kPairs, Orders::kHours,
                                         Orders::kRealDay};
inline constexpr int kRareDays = 10;
inline constexpr double kCapacityWh = BatteryNature{}.capacity_wh;

inline FaultResult try_rare(const char* fault, const Rhythm& rhythm, Orders orders,
                            double soc_frac = 0.45) {
  return try_fault({.fault = &trial_fault(fault),
                    .times = rhythm.times,
                    .orders = orders,
                    .soc_frac = soc_frac,
                    .cycles_max = kRareDays * kStepsPerDay});
}

inline double percent_of_capacity(double energy_wh) { return 100 * energy_wh / kCapacityWh; }

inline std::string say_rare(const FaultResult& r) {
  char text[120];
  const bool is_found = r.reason != Reason::kStudent;
  std::snprintf(text, sizeof text, "%s%.1f %% after %.1f h, told %.1f %%", is_found ? "" : "- ",
                percent_of_capacity(r.wrong_wh), r.cycles / 30.0,
                percent_of_capacity(r.wrong_until_told_wh));
  return text;
}

}  // namespace bess::trial
