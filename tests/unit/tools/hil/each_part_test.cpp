// bess-hil run --each-part: finds a part without effect, unless the scenario gives a reason, and a
// reason for a part that has an effect.
#include "tools/hil_runner/run/agreement.h"

#include <gmock/gmock.h>

#include "tests/support/temporary_folder.h"
#include "tools/hil_runner/run/run_scenario.h"
#include "tools/hil_runner/scenario/scenario_parts.h"

namespace bess {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> part_names(const Scenario& scenario) {
  std::vector<std::string> names;
  for (const ScenarioPart& part : parts_of(scenario)) names.push_back(part.name);
  return names;
}

Scenario scenario_of(const std::string& text) {
  const TemporaryFolder folder;
  return read_scenario(folder.write("s.toml", "title = \"x\"\nminutes = 30\n" + text));
}

std::vector<std::string> idle_parts(const std::string& text) {
  std::vector<std::string> rules;
  for (const Finding& f : judge_parts(run_scenario(scenario_of(text), true, {}))) {
    rules.push_back(f.rule);
  }
  return rules;
}

constexpr const char* kUnreadSpike = "[prices]\nsteps = [[0, 100], [20, 9000], [21, 100]]\n";

TEST(EachPart, IsWhatCanBeTakenAwayOnItsOwn) {
  EXPECT_THAT(part_names(scenario_of("")), IsEmpty());
  EXPECT_THAT(part_names(scenario_of("[prices]\nsteps = [[-60, 300], [-10, 100], [8, 9]]\n"
                                     "missing = [[3, 4], [5, 6]]\n"
                                     "[edge]\nguard = \"soc_min = 0.2\\nsoc_max = 0.8\"\n"
                                     "other = \"[[reserve]]\\nsoc = 0.4\"\n"
                                     "[battery_fault]\nkinds = [\"silence\"]\n"
                                     "[[event]]\nat_min = 3\ndoes = \"edge_stop\"\n")),
              ElementsAre("battery_fault", "event 1", "missing 1", "missing 2", "price step 1",
                          "price step 2", "price step 3", "edge guard soc_min",
                          "edge guard soc_max", "edge other"));
  EXPECT_THAT(part_names(scenario_of("[battery]\nmap = \"victron_ess3\"\ntransport = \"rtu\"\n")),
              ElementsAre("map", "transport"));
}

TEST(EachPart, TakesAwayThatPartAlone) {
  const Scenario whole = scenario_of(
      "[prices]\nmissing = [[3, 4], [5, 6]]\n"
      "[edge]\nguard = \"soc_min = 0.2\\nsoc_max = 0.8\"\n");
  const std::vector<ScenarioPart> parts = parts_of(whole);
  ASSERT_EQ(parts.size(), 4U);
  ASSERT_EQ(parts[0].without.prices.missing.size(), 1U);
  EXPECT_EQ(parts[0].without.prices.missing[0].from_min, 5);
  EXPECT_EQ(parts[0].without.edge_guard, whole.edge_guard);
  EXPECT_EQ(parts[2].without.edge_guard, "soc_max = 0.8\n");
  EXPECT_EQ(parts[3].without.edge_guard, "soc_min = 0.2\n");
  EXPECT_EQ(parts[3].without.prices.missing.size(), 2U);
}

TEST(EachPart, ThatChangesNothingIsFound) {
  EXPECT_THAT(idle_parts(kUnreadSpike), ElementsAre("part price step 2"));
  EXPECT_THAT(idle_parts("[prices]\nsteps = [[0, 100], [21, 9000], [22, 100]]\n"), IsEmpty());
  EXPECT_THAT(idle_parts(""), ElementsAre("part nothing"));
}

TEST(EachPart, MayBeExcusedWhereThatIsSo) {
  const std::string excuse = "[same_without]\n\"price step 2\" = \"no tick reads it\"\n";
  EXPECT_THAT(idle_parts(kUnreadSpike + excuse), IsEmpty());
  EXPECT_THAT(idle_parts("[prices]\nsteps = [[0, 100], [21, 9000], [22, 100]]\n" + excuse),
              ElementsAre("part price step 2"));
  EXPECT_THAT(idle_parts("[same_without]\nnothing = \"usual\"\n"), IsEmpty());
}

}  // namespace
}  // namespace bess
