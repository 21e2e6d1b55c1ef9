// Scenarios of meter, limits, operators, reserve, ramp and history: each passes, and without its
// subject its own expectations fail.
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>

#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

/// Subject of a scenario, and its removal; false: not its subject.
struct Subject {
  const char* name;
  bool (*take_away)(Scenario& scenario);
};

constexpr Subject kSubjects[] = {
    {"meter fault",
     [](Scenario& s) {
       const bool has = !s.meter.fault.faults.empty();
       s.meter.fault = {};
       return has;
     }},
    {"fault of the battery's grid point",
     [](Scenario& s) {
       std::size_t erased = 0;
       for (auto& fault : s.battery_faults) {
         erased += std::erase_if(fault.faults, is_of_grid);
       }
       return erased > 0;
     }},
    // For a wrong meter the limits are not the subject.
    {"limits of the connection",
     [](Scenario& s) {
       const bool lies = !s.meter.fault.faults.empty() || s.has_grid_fault();
       const bool has = !s.edge_meter.empty() && !lies;
       s.edge_meter.clear();
       return has;
     }},
    {"what is said",
     [](Scenario& s) {
       return std::erase_if(s.events, [](const auto& e) { return is_operator_event(e.kind); }) > 0;
     }},
    {"reserve",
     [](Scenario& s) {
       const bool has = s.edge_other.find("[[reserve]]") != std::string::npos;
       s.edge_other.clear();
       return has;
     }},
    {"ramp",
     [](Scenario& s) {
       const bool has = s.edge_guard.find("ramp_w_max") != std::string::npos;
       s.edge_guard.clear();
       return has;
     }},
    {"frozen price",
     [](Scenario& s) {
       const bool has = s.price_fault.fault == MarketFault::kFrozen;
       if (has) s.price_fault.fault = MarketFault::kNone;
       return has;
     }},
    {"history",  // the days before were equally low
     [](Scenario& s) {
       const bool has = s.prices.history_hours > 0;
       if (has) s.prices.steps.erase(s.prices.steps.begin());
       return has;
     }},
};

TEST(SiteScenarios, EachFailsWithoutWhatItIsAbout) {
  int tried = 0;
  for (const auto& file : std::filesystem::directory_iterator(BESS_SOURCE_DIR "/tests/scenarios")) {
    if (file.path().extension() != ".toml") continue;
    const Scenario scenario = read_scenario(file.path().string());
    if (!scenario.runs_virtual) continue;
    for (const Subject& subject : kSubjects) {
      Scenario without = scenario;
      if (!subject.take_away(without)) continue;
      ++tried;
      const Outcome outcome = run_scenario(without, true, {});
      EXPECT_TRUE(outcome.error.empty()) << scenario.name << ": " << outcome.error;
      EXPECT_TRUE(std::ranges::any_of(
          outcome.findings, [](const Finding& f) { return f.rule.starts_with("expect"); }))
          << scenario.name << " passes without its " << subject.name;
    }
  }
  EXPECT_GE(tried, 25);
}

TEST(SiteScenarios, AMeterThatIsNotThereIsLostAndNotIgnored) {
  Scenario scenario = read_scenario(BESS_SOURCE_DIR "/tests/scenarios/meter_lost.toml");
  scenario.meter.fault.from_s = -1e6;  // the edge starts before the scenario
  scenario.meter.fault.to_s = 60 * kNeverMin;
  const Outcome outcome = run_scenario(scenario, true, {});
  ASSERT_FALSE(outcome.evidence.log.empty());
  for (const CycleRecord& cycle : outcome.evidence.log) EXPECT_EQ(cycle.ordered_power_w, 0);
}

}  // namespace
}  // namespace bess
