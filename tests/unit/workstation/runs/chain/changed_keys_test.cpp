#include "workstation/runs/chain/learning_class.h"

#include <gmock/gmock.h>

#include "tests/support/tokens.h"

namespace bess {
namespace {

TEST(ChangedKeys, TheDefaultsChangeNothing) {
  EXPECT_TRUE(changed_keys({}).empty());
  RunConfig config;
  config.set_seed(7);
  EXPECT_TRUE(changed_keys(config).empty()) << "a seed is no key";
}

TEST(ChangedKeys, EachIsNamedWithBothValues) {
  const RunConfig config = parse_run_config(
      "[market]\nobservation_delay_min = 2\n[battery]\nwear_eur_per_mwh = 10.5\n"
      "[train]\nmethod = \"sdp\"\nresidual = true\n",
      "here");
  EXPECT_EQ(changed_keys(config).size(), 3U);
  EXPECT_THAT(changed_keys_text(config),
              Names("[market] observation_delay_min 2 1 [battery] wear_eur_per_mwh 10.5 0 [train] "
                    "method \"sdp\" \"c51\""));
}

}  // namespace
}  // namespace bess
