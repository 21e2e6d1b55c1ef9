// Real bess-edge with a real bess-prices that is killed, stopped, torn, full or of another version,
// at random moments: control continues, and no price is used beyond its age limit.
#include <gmock/gmock.h>
#include <signal.h>

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "edge/app/settings/edge_config.h"
#include "tests/support/simulated_site.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

using ::testing::HasSubstr;

/// The default, at the tick; the logged age is at the order, after the wait for a new one.
constexpr int kPriceAgeSMax = 240 + 20 + 1;

class PriceProcesses : public ::testing::Test {
 protected:
  PriceProcesses() {
    site_.start_battery({"--map", BESS_SOURCE_DIR "/edge/device/maps/alphaess.toml"});
    site_.start_market({}, SimulatedSite::minute_prices(400));
    config_ = site_.commission();
    auto config = std::make_unique<EdgeConfig>();
    std::string error;
    EXPECT_TRUE(load_edge_config(config_, *config, error)) << error;
    record_ = std::string(prices_file(*config).view());
  }
  void start_prices() {
    prices_ = std::make_unique<ChildProcess>(
        std::vector<std::string>{BESS_PRICES_PROGRAM, "--config", config_});
  }
  void wait_cycles(double cycles) const {
    usleep(static_cast<useconds_t>(cycles * 120e6 / kScale));
  }
  /// Replacement of the record, as no intact bess-prices leaves it.
  void write_record(const std::string& bytes) const {
    std::ofstream(record_ + ".new", std::ios::binary) << bytes;
    std::filesystem::rename(record_ + ".new", record_);
  }
  std::string record() const { return text_of_file(record_); }

  static constexpr int kScale = 150;  // a control cycle is 0.8 s
  SimulatedSite site_{kScale};
  std::string config_, record_;
  std::unique_ptr<ChildProcess> prices_;
};

TEST_F(PriceProcesses, WhateverHappensToTheFetcherTheLoopContinues) {
  const unsigned seed = 20'261'127;
  std::mt19937 random(seed);
  const auto drawn = [&](double from, double to) {
    return std::uniform_real_distribution<double>(from, to)(random);
  };
  start_prices();
  const int disturbances = few_or_all(20, 40);
  ChildProcess edge({BESS_EDGE_ALONE, "--config", config_, "--cycles", "70"});
  const std::function<void()> kinds[] = {
      [&] { prices_->signal(SIGKILL), wait_cycles(drawn(0, 4)), start_prices(); },
      [&] { prices_->signal(SIGSTOP), wait_cycles(drawn(0, 4)), prices_->signal(SIGCONT); },
      [&] { prices_->signal(SIGTERM), prices_->wait(), start_prices(); },
      [&] {
        std::string torn = record();
        if (!torn.empty()) torn.resize(random() % torn.size());
        write_record(torn);
      },
      [&] {
        std::string other = record();
        if (!other.empty()) other[0] = static_cast<char>(other[0] + 1);
        write_record(other);
      },
      [&] { write_record(std::string(static_cast<std::size_t>(drawn(0, 4'000)), '\xff')); },
      [&] { std::filesystem::remove(record_); },
  };
  for (int i = 0; i < disturbances; ++i) {
    wait_cycles(drawn(0, 3));
    kinds[random() % std::size(kinds)]();
  }
  const std::string said = edge.read_all();
  EXPECT_EQ(edge.wait(), 0) << said;
  int running = 0;
  for (const CsvRow& row : read_csv(site_.folder.file("edge.csv"))) {
    if (row.at("mode") == "stopping") continue;
    if (row.at("mode") != "running") continue;
    ++running;
    EXPECT_LE(std::atoi(row.at("price_age_s").c_str()), kPriceAgeSMax) << row.at("utc");
  }
  EXPECT_GT(running, 25);
}

TEST_F(PriceProcesses, WithoutItNothingIsDrivenAndItIsNamed) {
  ChildProcess edge({BESS_EDGE_ALONE, "--config", config_, "--cycles", "5"});
  const std::string said = edge.read_all();
  EXPECT_EQ(edge.wait(), 0) << said;
  EXPECT_THAT(said, HasSubstr("prices=no_fetcher"));
  EXPECT_THAT(said, ::testing::Not(HasSubstr("mode=running")));
}

TEST_F(PriceProcesses, ASecondOneIsRefused) {
  start_prices();
  for (int i = 0; i < 600 && record().empty(); ++i) usleep(50'000);
  ASSERT_NE(record(), "") << "the first one holds its lock";
  ChildProcess second({BESS_PRICES_PROGRAM, "--config", config_});
  EXPECT_THAT(second.read_all(), HasSubstr(std::to_string(prices_->pid())));
  EXPECT_EQ(second.wait(), 1);
}

}  // namespace
}  // namespace bess
