#include "workstation/chain/changed_keys.h"

#include <gtest/gtest.h>

namespace bess {
namespace {

TEST(ChangedKeys, TheDefaultsChangeNothing) {
  EXPECT_TRUE(changed_keys({}).empty());
  EXPECT_EQ(changed_keys_text({}), "none: every key has its default");
  RunConfig config;
  config.set_seed(7);
  EXPECT_TRUE(changed_keys(config).empty()) << "a seed is no key";
}

TEST(ChangedKeys, EachIsNamedWithBothValues) {
  const RunConfig config = parse_run_config(
      "[market]\nobservation_delay_min = 2\n[battery]\nwear_eur_per_mwh = 10.5\n"
      "[train]\nmethod = \"sdp\"\nresidual = true\n",
      "here");
  EXPECT_EQ(changed_keys_text(config),
            "[market] observation_delay_min = 2 (default 1); [battery] wear_eur_per_mwh = 10.5 "
            "(default 0); [train] method = \"sdp\" (default \"c51\")");
}

}  // namespace
}  // namespace bess
