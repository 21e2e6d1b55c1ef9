// `bess-edge --self-test` against the simulators: all parts pass, and each of them can fail.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/simulated_site.h"

namespace bess {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::HasSubstr;

struct Said {
  int exit_code;
  std::string text;
};

Said self_test(const std::string& config) {
  ChildProcess child({edge_program(), "--config", config, "--self-test"});
  std::string text = child.read_all();
  return {child.wait(), std::move(text)};
}

TEST(SelfTest, PassesWhereTheControllerCanWork) {
  SimulatedSite site(60);
  site.start_battery();
  site.start_market();
  const Said said = self_test(site.write_config());
  EXPECT_EQ(said.exit_code, 0) << said.text;
  EXPECT_THAT(said.text,
              AllOf(ContainsRegex("student +ok +[0-9]+ of"), ContainsRegex("signature +ok"),
                    ContainsRegex("network +ok"), ContainsRegex("storage +ok"),
                    ContainsRegex("battery +ok"), HasSubstr("self-test  passed")));
}

TEST(SelfTest, NamesWhatFails) {
  SimulatedSite site(60);
  const Said said = self_test(site.write_config());  // nobody listens
  EXPECT_EQ(said.exit_code, 1);
  EXPECT_THAT(said.text, AllOf(ContainsRegex("network +FAIL"), ContainsRegex("battery +FAIL"),
                               HasSubstr("self-test  2 parts failed")));
}

/// What --check says of a battery that is missing, or another one, in the battery's own line.
TEST(SelfTest, SaysOfTheBatteryWhatCheckSays) {
  SimulatedSite site(60);
  const auto check = [](const std::string& config) {
    ChildProcess child({edge_program(), "--config", config, "--check"});
    std::string text = child.read_all();
    child.wait();
    const std::string lead = "bess-edge: battery at ";
    const std::size_t at = text.find(lead);
    return at == text.npos ? text
                           : text.substr(at + lead.size(), text.find('\n', at) - at - lead.size());
  };
  const std::string missing = check(site.write_config());
  EXPECT_THAT(missing, HasSubstr("127.0.0.1:1 unit 85: no connection"));
  EXPECT_THAT(self_test(site.write_config()).text, HasSubstr("battery    FAIL  " + missing + "\n"));
  site.start_battery({"--capacity-wh", "20000"});
  const std::string another = check(site.write_config());
  EXPECT_THAT(another, HasSubstr("is this another battery?"));
  EXPECT_THAT(self_test(site.write_config()).text, HasSubstr("battery    FAIL  " + another + "\n"));
}

}  // namespace
}  // namespace bess
