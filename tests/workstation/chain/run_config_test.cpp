#include "workstation/chain/run_config.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tests/support/temporary_folder.h"

namespace bess {
namespace {

using testing::HasSubstr;

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
  EXPECT_EQ(again.battery.power_w_max, config.battery.power_w_max);
  EXPECT_EQ(again.battery.soc_min_frac, config.battery.soc_min_frac);
  EXPECT_EQ(again.battery.costs.import_adder_eur_per_mwh, 12.5);
  EXPECT_EQ(again.battery.costs.import_percent, 1.0 / 3);
  EXPECT_EQ(again.battery.costs.export_fee_eur_per_mwh, 2);
  EXPECT_EQ(again.battery.costs.export_percent, 100);
  EXPECT_EQ(again.train.method, Method::kDqn);
  EXPECT_EQ(again.train.source, Source::kReplay);
  EXPECT_EQ(again.train.residual, false);
  EXPECT_EQ(again.train.steps, 123'456);
  EXPECT_EQ(again.distil.omega, 2.5e-7);
  EXPECT_EQ(again.distil.correction.thresholds, (PriceThresholds{-120, 640}));
}

TEST(RunConfig, KeysOverlayTheDefaults) {
  const RunConfig config = parse_run_config(
      "[train]\nmethod = 'dqn'\nlearning_rate = 1\n[battery]\npower_w = 5000000\n", "some.toml");
  EXPECT_EQ(config.train.method, Method::kDqn);
  EXPECT_EQ(config.train.learning_rate, 1);
  EXPECT_EQ(config.battery.power_w_max, 5e6);
  EXPECT_EQ(config.battery.capacity_wh, RunConfig{}.battery.capacity_wh);
}

TEST(RunConfig, TheQuickStartsFileIsAHouseBatteryWithWear) {
  const RunConfig config = load_run_config(BESS_SOURCE_DIR "/workstation/house.toml");
  EXPECT_EQ(config.battery.power_w_max, 4'000);
  EXPECT_EQ(config.battery.capacity_wh, 8'000);
  EXPECT_EQ(config.battery.wear_eur_per_mwh, 30);
}

TEST(RunConfig, TheDefaultIsC51OnTheProgramsShoulders) {
  const RunConfig config = load_run_config({});
  EXPECT_EQ(config.train.method, Method::kC51);
  EXPECT_TRUE(config.train.residual);
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

struct BadConfig {
  const char* text;
  const char* place;  ///< after the file's name
  const char* complaint;
};

TEST(RunConfig, MistakesNamePlaceAndMend) {
  const BadConfig cases[] = {
      {"[market]\n[trian]\nsteps = 1\n", ":2: ", "unknown section or key \"trian\""},
      {"steps = 1\n", ":1: ", "unknown section or key \"steps\"; 'bess-train config' lists all"},
      {"\ntrain = 1\n", ":2: ", "\"train\""},
      {"[[train]]\nsteps = 1\n", ":1: ", "\"train\""},
      {"[train]\n\nstep = 1\n",
       ":3: ", "unknown key \"step\" in [train]; did you mean steps?; 'bess-train config'"},
      {"[market]\nsteps = 1\n", ":2: ", "unknown key \"steps\" in [market]"},
      {"[train]\nsteps = \"many\"\n", ":2: ", "[train] steps: expected a whole number"},
      {"[train]\nsteps = 1.5\n", ":2: ", "[train] steps: expected a whole number"},
      {"[train]\nsteps = true\n", ":2: ", "[train] steps: expected a whole number"},
      {"[train]\nsteps = [1]\n", ":2: ", "[train] steps: expected a whole number"},
      {"[train]\nsteps = {a = 1}\n", ":2: ", "[train] steps: expected a whole number"},
      {"[train]\nsteps = 2020-01-01\n", ":2: ", "[train] steps: expected a whole number"},
      {"[train.steps]\na = 1\n", ":1: ", "[train] steps: expected a whole number"},
      {"[train]\ngamma = \"x\"\n", ":2: ", "[train] gamma: expected a number"},
      {"[train]\ngamma = true\n", ":2: ", "[train] gamma: expected a number"},
      {"[train]\nresidual = 1\n", ":2: ", "[train] residual: expected true or false"},
      {"[train]\nresidual = \"true\"\n", ":2: ", "expected true or false"},
      {"[train]\nsteps = 0\n", ":2: ", "[train] steps: 0 is out of range: use 1 to 10000000"},
      {"[train]\nsteps = 9223372036854775807\n", ":2: ", "out of range: use 1 to"},
      {"[train]\nsteps = 9223372036854775808\n", ":2:", "not valid TOML"},
      {"[train]\ngamma = 1\n", ":2: ", "[train] gamma: 1 is out of range: use 0 to"},
      {"[train]\ngamma = nan\n", ":2: ", "[train] gamma: nan is out of range"},
      {"[train]\ngamma = inf\n", ":2: ", "[train] gamma: inf is out of range"},
      {"[train]\ngamma = -inf\n", ":2: ", "[train] gamma: -inf is out of range"},
      {"[market]\nobservation_delay_min = 6\n", ":2: ", "6 is out of range: use 0 to 5"},
      {"[correction]\nlow_price_eur_per_mwh = -15001\n", ":2: ", "use -15000 to 15000"},
      {"[distil]\n#\n\nomega = 0\n", ":4: ", "[distil] omega: 0 is out of range"},
      {"[train]\nmethod = \"C51\"\n", ":2: ", "[train] method: use one of \"c51\", \"dqn\""},
      {"[train]\nmethod = \"\"\n", ":2: ", "use one of \"c51\", \"dqn\""},
      {"[train]\nmethod = 1\n", ":2: ", "use one of \"c51\", \"dqn\""},
      {"[market]\nsettlement = \"hour\"\n", ":2: ", "use one of \"minute\", \"step\""},
      {"[train]\nsteps = \n", ":2: ", "not valid TOML"},
      {"[costs]\nimport_adder_eur_per_mwh = -1\n",
       ":2: ", "[costs] import_adder_eur_per_mwh: -1 is out of range: use 0 to 1000"},
      {"[costs]\nimport_percent = 100.5\n", ":2: ", "100.5 is out of range: use 0 to 100"},
      {"[costs]\nexport_fee_eur_per_mwh = 1001\n", ":2: ", "use 0 to 1000"},
      {"[costs]\nexport_percent = \"5 %\"\n", ":2: ", "[costs] export_percent: expected a number"},
      {"[costs]\nexport_percent = nan\n", ":2: ", "[costs] export_percent: nan is out of range"},
      {"[costs]\nwear_eur_per_mwh = 5\n", ":2: ", "unknown key \"wear_eur_per_mwh\" in [costs]"},
      {"[train\nsteps = 1\n", ":1: ", "not valid TOML"},
      {"[train]\nsteps = 1\nsteps = 2\n", ":3: ", "not valid TOML"},
      {"[train]\nsteps = 1\n[train]\n", ":3: ", "not valid TOML"},
      {"\xff\xfe", ":1: ", "not valid TOML"},
      {"[battery]\nsoc_min = 0.8\nsoc_max = 0.8\n", ": ",
       "[battery] soc_min must be below soc_max"},
      {"[battery]\nsoc_min = 0.8\nsoc_max = 0.2\n", ": ",
       "[battery] soc_min must be below soc_max"},
      {"[battery]\ninitial_soc = 0.05\n", ": ", "[battery] initial_soc 0.05 is outside"},
      {"[battery]\nsoc_max = 0.4\n", ": ", "[battery] initial_soc 0.5 is outside"},
      {"[train]\nvalue_min_eur_per_h = 5e8\n", ": ", "[train] value_min_eur_per_h must be below"},
      {"[train]\nhorizon = \"day\"\n", ": ", "[train] horizon = \"day\" needs residual = false"},
      {"[train]\ninput_calm = true\n", ":2: ", "unknown key \"input_calm\" in [train]"},
      {"[train]\npotential = \"sdp\"\n", ":2: ", "unknown key \"potential\" in [train]"},
      {"[train]\nbf16 = true\n", ":2: ", "unknown key \"bf16\" in [train]"},
      {"[train]\ncontext = \"outlook\"\nresidual = false\n", ": ",
       "[train] context = \"outlook\" needs residual = true"},
      {"[train]\ncontext = \"outlook\"\nsource = \"replay\"\n", ": ",
       "and source = \"counterfactual\""},
      {"[train]\natoms = 50\n", ": ", "[train] residual needs an odd number of atoms, not 50"},
      {"[correction]\nlow_price_eur_per_mwh = 1500\n", ": ",
       "[correction] low_price_eur_per_mwh must be below"},
      {"[correction]\nlow_price_eur_per_mwh = 9\nhigh_price_eur_per_mwh = 8\n", ": ",
       "[correction] low_price_eur_per_mwh must be below high_price_eur_per_mwh"},
  };
  for (const BadConfig& c : cases) {
    SCOPED_TRACE(c.text);
    try {
      static_cast<void>(parse_run_config(c.text, "some/run.toml"));
      ADD_FAILURE() << "accepted";
    } catch (const UserError& error) {
      EXPECT_THAT(error.what(), HasSubstr(std::string("some/run.toml") + c.place));
      EXPECT_THAT(error.what(), HasSubstr(c.complaint));
    }
  }
}

TEST(RunConfig, MissingFileIsNamed) {
  const TemporaryFolder folder;
  try {
    static_cast<void>(load_run_config(folder.file("missing.toml")));
    ADD_FAILURE() << "accepted";
  } catch (const UserError& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder.file("missing.toml")));
  }
}

TEST(CycleLimit, AndWearAreKeysWithRanges) {
  const RunConfig config =
      parse_run_config("[battery]\nwear_eur_per_mwh = 7.5\ncycles_per_day_max = 2\n", "a.toml");
  EXPECT_EQ(config.battery.wear_eur_per_mwh, 7.5);
  EXPECT_EQ(config.battery.cycles_per_day_max, 2);
  EXPECT_EQ(parse_run_config(format_run_config(config), "b.toml").battery.wear_eur_per_mwh, 7.5);
  EXPECT_THROW(parse_run_config("[battery]\nwear_eur_per_mwh = -1\n", "c.toml"), UserError);
}

}  // namespace
}  // namespace bess
