// Runs of a battery with such high costs that it idles: trained and proved in seconds.
#pragma once

#include <stdlib.h>

#include <filesystem>
#include <map>

#include "tests/support/small_market.h"
#include "tests/support/train_commands.h"

namespace bess {

inline constexpr const char* kIdleCosts =
    "[costs]\nimport_adder_eur_per_mwh = 1000\nimport_percent = 100\n"
    "export_fee_eur_per_mwh = 1000\nexport_percent = 100\n";
/// Above every price.
inline constexpr const char* kNoThresholds =
    "[correction]\nlow_price_eur_per_mwh = -501\nhigh_price_eur_per_mwh = 1501\n";

class IdleRun : public TrainCommands {
 protected:
  IdleRun() { setenv("SOURCE_DATE_EPOCH", "1700000000", 1); }  // or the page shows its time

  /// Every file except the times, and any remains.
  static std::map<std::string, std::string> contents(const std::filesystem::path& folder) {
    std::map<std::string, std::string> files;
    for (const auto& entry : std::filesystem::directory_iterator(folder)) {
      const std::string name = entry.path().filename().string();
      if (name != "times.json") files[name] = read_file(entry.path());
    }
    return files;
  }
  static void expect_same(const std::filesystem::path& folder,
                          const std::map<std::string, std::string>& whole) {
    const auto files = contents(folder);
    for (const auto& [name, text] : whole) {
      ASSERT_TRUE(files.contains(name)) << name << " is missing";
      EXPECT_TRUE(files.at(name) == text) << name << " differs";
    }
    for (const auto& [name, text] : files) EXPECT_TRUE(whole.contains(name)) << name << " is left";
  }
};

}  // namespace bess
