// Scenarios of day-ahead prices with a student by outlook: every fault of the auction is in one,
// and the replanning rule finds wrong break-even prices.
#include <gmock/gmock.h>

#include <filesystem>
#include <set>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/run/run_scenario.h"
#include "tools/hil_runner/scenario/edge_settings.h"

namespace bess {
namespace {

const std::string kFolder = BESS_SOURCE_DIR "/tests/scenarios/outlook/";

Scenario scenario_of(const std::string& text) {
  const TemporaryFolder folder;
  return read_scenario(folder.write("s.toml", "title = \"x\"\nminutes = 30\n" + text));
}

std::string refusal(const std::string& text) {
  return refusal_of([&] { return scenario_of(text); });
}

/// The rule's result for a run with a modified log.
template <typename Change>
std::vector<std::string> found_after(const Change& change) {
  Outcome run = run_scenario(read_scenario(kFolder + "good_day.toml"), true, {});
  EXPECT_TRUE(run.passed()) << complaint(run);
  const WorkFolder folder;
  const EdgeConfig config = load_edge_settings(run.scenario, folder.file("edge.toml"),
                                               edge_settings(run.scenario, run.prices, {}));
  run.scenario.invariants = {"outlook"};
  run.scenario.expectations.clear();
  for (CycleRecord& cycle : run.evidence.log) {
    if (cycle.outlook.source != OutlookSource::kNone) change(cycle);
  }
  std::vector<std::string> expected;
  for (const Finding& f : judge({run.scenario, run.prices, config, run.evidence})) {
    if (f.rule == "outlook") expected.push_back(f.expected);
  }
  return expected;
}

TEST(OutlookScenarios, EveryFaultOfTheAuctionIsInOne) {
  std::set<AuctionFault> tried;
  for (const auto& entry : std::filesystem::directory_iterator(kFolder)) {
    tried.insert(read_scenario(entry.path().string()).day_ahead.value().fault);
  }
  for (int fault = 0; fault < static_cast<int>(AuctionFault::kAll); ++fault) {
    EXPECT_TRUE(tried.contains(AuctionFault(fault))) << kAuctionFaultNames[fault];
  }
}

TEST(OutlookScenarios, TheRuleFindsACent) {
  EXPECT_THAT(found_after([](CycleRecord&) {}), ::testing::IsEmpty());
  const auto found = found_after([](CycleRecord& cycle) { ++cycle.outlook.break_even_centi; });
  ASSERT_EQ(found.size(), 1U);
}

TEST(OutlookScenarios, TheRuleFindsKnowledgeOfTomorrowBeforeOne) {
  const auto found = found_after([](CycleRecord& cycle) {
    if (cycle.outlook.known_quarter_hours <= 96) ++cycle.outlook.known_quarter_hours;
  });
  ASSERT_EQ(found.size(), 1U);
  EXPECT_THAT(found[0], Names("13:00"));
}

TEST(OutlookScenarios, TheRuleFindsAPlanOnWhatIsUsual) {
  EXPECT_EQ(found_after([](CycleRecord& cycle) {
              cycle.outlook.source = OutlookSource::kUsual;
              cycle.outlook.known_quarter_hours = 0;
            }).size(),
            1U);
}

/// Prices that are an hour late are correct in number only.
TEST(OutlookScenarios, TheRuleFindsPricesThatAreNotTheAuctions) {
  for (const char* name : {"shifted_hour", "hours"}) {
    Scenario scenario = read_scenario(kFolder + name + ".toml");
    scenario.invariants = {"outlook"};
    const Outcome run = run_scenario(scenario, true, {});
    ASSERT_EQ(run.findings.size(), 1U) << name;
    EXPECT_EQ(run.findings[0].rule, "outlook");
  }
}

TEST(OutlookScenarios, AnExpectedSourceCanFail) {
  for (const char* expected :
       {"outlook = \"usual\"", "outlook = \"planned\"\nquarter_hours = [0, 3]"}) {
    const Outcome run = run_scenario(
        scenario_of(std::string("[day_ahead]\n[[expect]]\n") + expected + "\n"), true, {});
    ASSERT_EQ(run.findings.size(), 1U) << expected;
    EXPECT_EQ(run.findings[0].rule, "expect 1");
    EXPECT_THAT(run.findings[0].seen, Names("planned 88"));
  }
}

TEST(OutlookScenarios, WhatNothingReadsIsRefused) {
  EXPECT_THAT(refusal("[day_ahead]\nmend_min = 3\n"), Names("mend_min fault"));
  EXPECT_THAT(refusal("[day_ahead]\nfault = \"lost\"\n"), Names("fault"));
  EXPECT_THAT(refusal("[day_ahead]\nfault = \"half\"\nto_min = 40\n"), Names("to_min 30"));
  EXPECT_THAT(refusal("[[expect]]\nquarter_hours = [9, 2]\n"), Names("quarter_hours"));
  EXPECT_THAT(refusal("[[expect]]\ncommand = \"zero\"\nquarter_hours = [2, 9]\n"),
              Names("quarter_hours outlook"));
}

}  // namespace
}  // namespace bess
