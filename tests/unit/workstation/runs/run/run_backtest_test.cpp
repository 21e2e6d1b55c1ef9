// Walk-forward figure of a run: of its own prices, seed and keys, or none, with the reason.
#include "workstation/runs/run/run_backtest.h"

#include <gmock/gmock.h>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"

namespace bess {
namespace {

using testing::HasSubstr;

RunRecord record_of(const RunConfig& config) {
  RunRecord record;
  record.identity = identity_of(config, "crc32 0badcafe, 7 minutes from 2023-01-01T00:00:00Z", "");
  return record;
}

void write_backtest(const RunFolder& folder, const std::string& learnt_from, const char* policy) {
  Json json = Json::object({{"learnt_from", learnt_from}});
  Json policies = Json::list();
  policies.add(Json::object({{"policy", "rbc"}, {"profit_eur_per_day_per_mwh", 1}}));
  policies.add(Json::object({{"policy", policy},
                             {"days", 90},
                             {"months", 3},
                             {"profit_eur_per_day_per_mwh", 412.3456},
                             {"profit_standard_error", 20.25},
                             {"profit_standard_error_by_month", 31.5}}));
  json.set("policies", std::move(policies));
  write_file(folder.path / kRunsBacktest / kBacktestJson, json.text());
}

TEST(RunBacktest, IsTakenWhenItIsOfTheSamePricesSeedAndKeys) {
  const TemporaryFolder temporary;
  const RunFolder folder{temporary.file("run")};
  RunConfig config;
  config.set_seed(7);
  const RunRecord record = record_of(config);
  EXPECT_THAT(walk_forward_text(walk_forward_of(folder, record)),
              Names("bess-train backtest --seed 7 --out RUN/backtest"));
  EXPECT_EQ(with_run_folder("--out RUN/backtest RUN/a", "x/run"), "--out x/run/backtest x/run/a");
  const std::string identity = learning_identity(record.value("prices"), config);
  write_backtest(folder, identity, kChainName);
  const WalkForwardOfRun walk = walk_forward_of(folder, record);
  ASSERT_TRUE(walk.figure.has_value()) << walk.why_none;
  EXPECT_THAT(walk_forward_text(walk), Names("412.3 20.2 31.5 90 3"));
  EXPECT_THAT(walk_forward_html(walk), HasSubstr("<a href=\"backtest/backtest.html\">"));
  EXPECT_THAT(walk_forward_json(*walk.figure).line(),
              HasSubstr("\"profit_eur_per_day_per_mwh\":412.3456"));
}

TEST(RunBacktest, OfAnythingElseIsNotTaken) {
  const TemporaryFolder temporary;
  const RunFolder folder{temporary.file("run")};
  RunConfig config;
  config.set_seed(7);
  const RunRecord record = record_of(config);
  RunConfig other = config;
  other.battery.wear_eur_per_mwh = 25;
  RunConfig seeded = config;
  seeded.set_seed(8);
  for (const std::string& identity :
       {learning_identity(record.value("prices"), other),
        learning_identity(record.value("prices"), seeded),
        learning_identity("crc32 00000000, 7 minutes from 2023-01-01T00:00:00Z", config)}) {
    write_backtest(folder, identity, kChainName);
    const WalkForwardOfRun walk = walk_forward_of(folder, record);
    EXPECT_FALSE(walk.figure.has_value());
    EXPECT_THAT(walk.why_none, Names("backtest/backtest.json bess-train backtest --seed 7"));
  }
  write_backtest(folder, learning_identity(record.value("prices"), config), "sdp");
  EXPECT_THAT(walk_forward_of(folder, record).why_none, Names("backtest/backtest.json student"));
  write_file(folder.path / kRunsBacktest / kBacktestJson, "{ half of a");
  EXPECT_FALSE(walk_forward_of(folder, record).figure.has_value());
}

}  // namespace
}  // namespace bess
