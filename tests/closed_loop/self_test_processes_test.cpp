// `bess-edge --self-test` against the simulators: all parts pass, and each of them can fail.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/edge_answer.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;

Said self_test(const std::string& config) { return edge({"--config", config, "--self-test"}); }

TEST(SelfTest, PassesWhereTheControllerCanWork) {
  SimulatedSite site(60);
  site.start_battery();
  site.start_market();
  const Said said = self_test(site.write_config());
  EXPECT_EQ(said.exit_code, 0) << said.text;
  EXPECT_THAT(said.text, AllOf(ContainsRegex("student +ok +[0-9]+ of"),
                               ContainsRegex("signature +ok"), ContainsRegex("network +ok"),
                               ContainsRegex("storage +ok"), ContainsRegex("battery +ok")));
}

TEST(SelfTest, NamesWhatFails) {
  SimulatedSite site(60);
  const Said missing = self_test(site.write_config());  // nobody listens
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.text, AllOf(ContainsRegex("network +FAIL"),
                                  ContainsRegex("battery +FAIL +127[.]0[.]0[.]1:1 ")));
  EXPECT_THAT(missing.text, ContainsRegex("student +ok"));
  site.start_battery({"--capacity-wh", "20000"});
  const Said another = self_test(site.write_config());
  EXPECT_EQ(another.exit_code, 1);
  EXPECT_THAT(another.text,
              AllOf(ContainsRegex("battery +FAIL"), Names("capacity 20000 capacity_wh")));
}

}  // namespace
}  // namespace bess
