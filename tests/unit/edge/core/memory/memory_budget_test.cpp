// Memory budget in edge/core/memory/README.md against the program: no object is larger than its
// row, no row is far larger than its object, and the sum is correct.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string>

#include "edge/app/program/controller.h"
#include "edge/app/program/real_world.h"
#include "edge/core/memory/heap_seal.h"

namespace bess {
namespace {

using Loop = Controller<RealWorld>::Loop;

/// First column to second column of the table under the heading.
std::map<std::string, std::size_t> read_budget() {
  std::ifstream file(BESS_SOURCE_DIR "/edge/core/memory/README.md");
  std::string line;
  while (std::getline(file, line) && line != "## Memory budget") continue;
  std::map<std::string, std::size_t> budget;
  while (std::getline(file, line) && !line.starts_with("#")) {
    const std::size_t end = line.find(" | ");
    if (!line.starts_with("| ") || end == std::string::npos) continue;
    std::string name = line.substr(2, end - 2);
    if (name.starts_with("`")) name = name.substr(1, name.size() - 2);
    const std::size_t kib = std::strtoul(line.c_str() + end + 3, nullptr, 10);
    if (kib > 0) budget[name] = kib;
  }
  return budget;
}

TEST(MemoryBudget, OfTheReadmeIsTrue) {
  const std::map<std::string, std::size_t> actual_bytes = {
      {"kControlStackBytes", kControlStackBytes},
      {"PriceReader", sizeof(PriceReader)},
      {"EdgeConfig", sizeof(EdgeConfig)},
      {"ModbusBattery", sizeof(ModbusBattery)},
      {"ModbusMeter", sizeof(ModbusMeter)},
      {"ControlLoop", sizeof(Loop)},
      {"EdgeClock", sizeof(EdgeClock)},
      {"HoldWatch", sizeof(HoldWatch)},
      {"ExchangeRecorder", sizeof(ExchangeRecorder)},
      {"EventLog", sizeof(EventLog)},
  };
  std::map<std::string, std::size_t> budget = read_budget();
  std::size_t sum_kib = 0;
  for (const auto& [name, bytes] : actual_bytes) {
    ASSERT_TRUE(budget.contains(name))
        << name << " is not in the table of edge/core/memory/README.md";
    EXPECT_LE(bytes, budget[name] * 1'024) << name << " has outgrown edge/core/memory/README.md";
    EXPECT_GE(bytes + 4'096, budget[name] * 1'024 / 2) << name << " is far smaller by now";
    sum_kib += budget[name];
  }
  EXPECT_EQ(budget["sum"], sum_kib);
  EXPECT_EQ(budget.size(), actual_bytes.size() + 1) << "a row without an object";
}

}  // namespace
}  // namespace bess
