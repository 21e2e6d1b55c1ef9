#include "workstation/runs/chain/run_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/host/file.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/tokens.h"
#include "tests/support/user_error_of.h"
#include "workstation/runs/chain/common_options.h"

namespace bess {
namespace {

TEST(RunConfig, DefaultsRoundTrip) {
  const std::string text = format_run_config({});
  EXPECT_EQ(format_run_config(parse_run_config(text, "defaults.toml")), text);
  EXPECT_EQ(format_run_config(parse_run_config("", "empty.toml")), text);
  EXPECT_EQ(format_run_config(load_run_config({})), text);
}

TEST(RunConfig, ChangedValuesRoundTrip) {
  RunConfig config;
  config.market.observation_delay_min = 3;
  config.market.settlement = Settlement::kStep;
  config.battery.power_w_max = 1.0 / 3 * 1e7;
  config.battery.soc_min_frac = 0.123456789012345;
  config.battery.costs = {12.5, 1.0 / 3, 2, 100};
  config.initial_soc_frac = 0.3;
  config.train.method = Method::kDqn;
  config.train.source = Source::kReplay;
  config.train.residual = false;
  config.train.learning_rate = 3.1e-5;
  config.train.steps = 123'456;
  config.train.value_min_eur_per_h = -1e9;
  config.distil.omega = 2.5e-7;
  config.distil.correction.thresholds = {-120, 640};
  const RunConfig again = parse_run_config(format_run_config(config), "changed.toml");
  EXPECT_EQ(format_run_config(again), format_run_config(config));
  EXPECT_EQ(again.market.settlement, Settlement::kStep);
  EXPECT_EQ(again.battery.soc_min_frac, config.battery.soc_min_frac);
  EXPECT_EQ(again.battery.costs.import_percent, 1.0 / 3);
  EXPECT_EQ(again.train.residual, false);
  EXPECT_EQ(again.train.steps, 123'456);
  EXPECT_EQ(again.distil.omega, 2.5e-7);
  EXPECT_EQ(again.distil.correction.thresholds, (PriceThresholds{-120, 640}));
}

TEST(RunConfig, TheQuickStartsFileIsAHouseBatteryWithWear) {
  const RunConfig config = load_run_config(BESS_SOURCE_DIR "/workstation/house.toml");
  EXPECT_EQ(config.battery.power_w_max, 4'000);
  EXPECT_EQ(config.battery.capacity_wh, 8'000);
  EXPECT_EQ(config.battery.wear_eur_per_mwh, 30);
}

TEST(RunConfig, TheContextIsWhatTheFileSaysAndElseWhatDayAheadPricesMakeIt) {
  const TemporaryFolder folder;
  const auto path = folder.file("mine.toml");
  const auto context_of = [&](const char* text) {
    write_file(path, text);
    return load_run_config(path, ContextKind::kOutlook).train.context;
  };
  EXPECT_EQ(load_run_config({}).train.context, ContextKind::kLevel);
  EXPECT_EQ(load_run_config({}, ContextKind::kOutlook).train.context, ContextKind::kOutlook);
  EXPECT_EQ(context_of("[train]\nmethod = \"sdp\"\n"), ContextKind::kOutlook);
  EXPECT_EQ(context_of("[train]\ncontext = \"level\"\n"), ContextKind::kLevel);
  EXPECT_THROW(context_of("[train]\nsource = \"replay\"\n"), UserError);
}

TEST(RunConfig, PaperFileIsValid) {
  const RunConfig config =
      load_run_config(std::string(BESS_SOURCE_DIR) + "/workstation/config/paper.toml");
  EXPECT_EQ(config.train.batch_size, 16'384);
  EXPECT_EQ(config.train.source, Source::kReplay);
  EXPECT_EQ(config.train.steps, 50'000);
  EXPECT_EQ(config.train.horizon, Horizon::kDay);
  EXPECT_EQ(config.train.value_min_eur_per_h, -1e5);
  EXPECT_EQ(config.train.value_max_eur_per_h, 1e5);
  EXPECT_FALSE(config.train.residual);
}

TEST(RunConfig, MistakesNamePlaceKeyAndWhatIsRefused) {
  const std::pair<const char*, const char*> cases[] = {
      {"[market]\n[trian]\nsteps = 1\n", "run.toml:2 trian train"},
      {"steps = 1\n", "run.toml:1 steps bess-train config"},
      {"\ntrain = 1\n", "run.toml:2 train table"},
      {"[[train]]\nsteps = 1\n", "run.toml:1 train table"},
      {"[train]\n\nstep = 1\n", "run.toml:3 [train] step steps bess-train config"},
      {"[market]\nsteps = 1\n", "run.toml:2 [market] steps"},
      {"[train]\nsteps = \"many\"\n", "run.toml:2 [train] steps"},
      {"[train]\nsteps = 1.5\n", "run.toml:2 [train] steps"},
      {"[train]\nsteps = {a = 1}\n", "run.toml:2 [train] steps"},
      {"[train.steps]\na = 1\n", "run.toml:1 [train] steps"},
      {"[train]\ngamma = \"x\"\n", "run.toml:2 [train] gamma"},
      {"[train]\nresidual = 1\n", "run.toml:2 [train] residual"},
      {"[train]\nsteps = 0\n", "run.toml:2 [train] steps 0 1 10000000"},
      {"[train]\nsteps = 9223372036854775807\n", "run.toml:2 [train] steps 10000000"},
      {"[train]\ngamma = 1\n", "run.toml:2 [train] gamma 1 0"},
      {"[train]\ngamma = nan\n", "run.toml:2 [train] gamma nan"},
      {"[train]\ngamma = -inf\n", "run.toml:2 [train] gamma -inf"},
      {"[market]\nobservation_delay_min = 6\n", "run.toml:2 observation_delay_min 6 0 5"},
      {"[correction]\nlow_price_eur_per_mwh = -15001\n", "run.toml:2 -15001 -15000 15000"},
      {"[distil]\n#\n\nomega = 0\n", "run.toml:4 [distil] omega 0"},
      {"[train]\nmethod = \"C51\"\n", "run.toml:2 [train] method \"c51\" \"dqn\" \"C51\""},
      {"[train]\nmethod = 1\n", "run.toml:2 [train] method"},
      {"[costs]\nimport_percent = 100.5\n", "run.toml:2 [costs] import_percent 100.5 0 100"},
      {"[costs]\nexport_percent = \"5 %\"\n", "run.toml:2 [costs] export_percent"},
      {"[battery]\nwear_eur_per_mwh = -1\n", "run.toml:2 [battery] wear_eur_per_mwh -1"},
      {"[train\nsteps = 1\n", "run.toml:1"},
      {"[battery]\nsoc_min = 0.8\nsoc_max = 0.8\n", "run.toml [battery] soc_min soc_max"},
      {"[battery]\ninitial_soc = 0.05\n", "run.toml [battery] initial_soc 0.05"},
      {"[battery]\nsoc_max = 0.4\n", "run.toml [battery] initial_soc 0.5"},
      {"[battery]\ncold_power_share = 0.6\n", "cold_from_hour cold_to_hour"},
      {"[train]\nvalue_min_eur_per_h = 5e8\n", "run.toml [train] value_min_eur_per_h"},
      {"[train]\nhorizon = \"day\"\n", "run.toml [train] horizon \"day\" residual"},
      {"[train]\ncontext = \"outlook\"\nresidual = false\n", "[train] context residual = true"},
      {"[train]\ncontext = \"outlook\"\nsource = \"replay\"\n", "source \"counterfactual\""},
      {"[train]\natoms = 50\n", "run.toml [train] residual 50"},
      {"[correction]\nlow_price_eur_per_mwh = 9\nhigh_price_eur_per_mwh = 8\n",
       "run.toml [correction] low_price_eur_per_mwh high_price_eur_per_mwh"},
  };
  for (const auto& [text, names] : cases) {
    SCOPED_TRACE(text);
    EXPECT_THAT(refusal_of([&] { parse_run_config(text, "some/run.toml"); }), Names(names));
  }
}

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

namespace fs = std::filesystem;

TEST(SourceTree, IsFoundFromAnyFolderInIt) {
  const TemporaryFolder folder;
  const fs::path tree = folder.file("bess");
  write_file(tree / "edge/CMakeLists.txt", "");
  write_file(tree / "edge/generated/student_weights.h", "");
  fs::create_directories(tree / "build/deep");
  for (const fs::path& at : {tree, tree / "edge", tree / "build/deep"}) {
    EXPECT_EQ(header_in_tree_around(at), tree / "edge/generated/student_weights.h") << at;
  }
  EXPECT_EQ(header_in_tree_around(folder.file("")), std::nullopt);
}

TEST(SourceTree, AFolderThatOnlyLooksLikeItIsNone) {
  const TemporaryFolder folder;  // remains of an export into the wrong folder
  write_file(folder.file("edge/generated/student_weights.h"), "");
  EXPECT_EQ(header_in_tree_around(folder.file(".")), std::nullopt);
  EXPECT_EQ(header_in_tree_around("/"), std::nullopt);
  EXPECT_EQ(header_in_tree_around(""), std::nullopt);
}

}  // namespace
}  // namespace bess
