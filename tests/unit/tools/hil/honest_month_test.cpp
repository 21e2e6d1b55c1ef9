// A month of real prices on every shipped map in virtual time, through the edge's own link, frames
// and registers, with a battery that is slow, noisy and slow near its limits: the battery never
// causes a stop.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>

#include "edge/core/control/control_types.h"
#include "tests/support/shipped_maps.h"
#include "tests/support/temporary_folder.h"
#include "tests/support/thorough.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

/// All findings of the supervision.
constexpr Reason kFindings[] = {
    Reason::kWrongDirection, Reason::kUncontrolledPower, Reason::kSocMismatch, Reason::kOtherMaster,
    Reason::kOrdersFail,     Reason::kNoAnswer,          Reason::kCapacity,    Reason::kSocJump};

std::string scenario_text(const MapVariant& variant, int days) {
  std::string text =
      "title = \"A month\"\ntime = \"virtual\"\nminutes = " + std::to_string(days * 24 * 60) +
      "\nstart_utc = \"2023-02-01T00:00:00Z\"\n[prices]\nfile = \"" BESS_SOURCE_DIR
      "/tests/data/benchmark_minutes_2023.csv.gz\"\n[battery]\nmap = \"" +
      std::string(variant.map) + "\"\n";
  if (*variant.variant != '\0') text += std::string("variant = \"") + variant.variant + "\"\n";
  if (load_shipped_map(variant).watchdog.duration_s == 0) {
    text += "[edge]\nbattery = \"allow_without_watchdog = true\"\n";
  }
  text += "[battery_fault]\nkinds = [\"slow-and-noisy\", \"throttle\"]\nfrom_min = 0\n";
  // To the simulator 0 W in this mode is no order.
  if (variant.variant == std::string("bms_mode")) {
    text += "[judge]\nall_but = [\"order\", \"in_control\"]\n";
  }
  for (const Reason reason : kFindings) {
    text += "[[expect]]\nfrom_min = 0\nno_reason = \"" + std::string(reason_name(reason)) + "\"\n";
  }
  return text;
}

class HonestMonth : public ::testing::TestWithParam<MapVariant> {};

TEST_P(HonestMonth, IsNeverStoppedForWhatTheBatteryDoes) {
  const int days = few_or_all(2, 30);
  const TemporaryFolder folder;
  const Scenario scenario =
      read_scenario(folder.write("month.toml", scenario_text(GetParam(), days)));
  const Outcome outcome = run_scenario(scenario, true, {});
  EXPECT_TRUE(outcome.passed()) << complaint(outcome);
  EXPECT_TRUE(outcome.skipped.empty()) << outcome.skipped;
  const auto lost = std::ranges::count_if(outcome.evidence.log, [](const CycleRecord& cycle) {
    return cycle.mode != Mode::kRunning && cycle.mode != Mode::kStopping;
  });
  std::printf("%-16s %-12s %td of %zu cycles lost in %d days\n", GetParam().map, GetParam().variant,
              lost, outcome.evidence.log.size(), days);
  EXPECT_EQ(lost, 0);
}

INSTANTIATE_TEST_SUITE_P(Maps, HonestMonth, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
