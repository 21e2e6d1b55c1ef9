#include "workstation/runs/run/run_report.h"

#include <gmock/gmock.h>
#include <stdlib.h>

#include <algorithm>

#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/unit/workstation/report/report_test_support.h"

namespace bess {
namespace {

using testing::MatchesRegex;

std::string value_of(const std::vector<Fact>& facts, const std::string& name) {
  const auto found = std::ranges::find(facts, name, &Fact::name);
  return found == facts.end() ? "" : found->value;
}

class RunFacts : public testing::Test {
 protected:
  ~RunFacts() override { unsetenv("SOURCE_DATE_EPOCH"); }

  std::vector<Fact> facts() {
    return run_facts(RunConfig{}, small_market(), RunFolder{folder_.file("")});
  }

  void put(const std::string& name, const std::string& text) const {
    (void)folder_.write(name, text);
  }

  TemporaryFolder folder_;
};

TEST_F(RunFacts, PricesAreNamedWithTheirChecksum) {
  const auto prices = folder_.write("market.csv", "123456789");  // the check value of CRC-32
  put("run.json", "{\"prices\": \"" + prices + "\"}");
  EXPECT_THAT(value_of(facts(), "prices"), Names("market.csv crc32 cbf43926 9"));
}

TEST_F(RunFacts, SayWhenWhereAndHow) {
  put("run.json", "{}");
  put("times.json", R"({"teacher": {"seconds": 12.25, "finished_utc": "x"}})");
  const std::vector<Fact> all = facts();
  EXPECT_THAT(value_of(all, "date"), MatchesRegex("20..-..-..T..:..:..Z"));
  EXPECT_THAT(value_of(all, "command"), Names("report_test"));
  EXPECT_THAT(value_of(all, "program"), MatchesRegex("bess-train .*, commit .*"));
  EXPECT_THAT(value_of(all, "span"), Names("2023-01-01 2023-02-28 40"));
  EXPECT_THAT(value_of(all, "observation delay"), Names("1"));
  EXPECT_EQ(value_of(all, "stages"), "teacher 12.2 s");
  EXPECT_NE(value_of(all, "host"), "");
}

TEST_F(RunFacts, AFixedDateLeavesOutWhatDiffers) {
  put("run.json", "{}");
  put("times.json", R"({"teacher": {"seconds": 12.2, "finished_utc": "x"}})");
  setenv("SOURCE_DATE_EPOCH", "1700000000", 1);
  const std::vector<Fact> all = facts();
  EXPECT_EQ(value_of(all, "date"), "2023-11-14T22:13:20Z");
  for (const char* name : {"host", "command", "computed for", "stages"}) {
    EXPECT_EQ(value_of(all, name), "") << name;
  }
}

}  // namespace
}  // namespace bess
