// Supervision of healthy batteries: days of real prices on each variant, without a trip.
#include <gtest/gtest.h>

#include <span>
#include <string_view>

#include "tests/support/thorough.h"
#include "tests/system/trial/trial_run.h"

namespace bess::trial {
namespace {

#ifdef BESS_SANITIZED
const int kDays = 1;
#else
const int kDays = few_or_all(3, 30);
#endif

class HonestBattery : public ::testing::TestWithParam<HonestVariant> {};

TEST_P(HonestBattery, TripsNothing) {
  const HonestDays days = live_honest_days(GetParam(), kDays);
  EXPECT_EQ(days.trips, 0) << reason_name(days.first_trip) << " in cycle " << days.first_trip_cycle;
  EXPECT_GT(days.driven, days.cycles / 3);
  EXPECT_LT(days.wrong_energy_e6_max, WrongEnergy::kReportedE6);
  EXPECT_GT(days.moved_wh, kDays * GetParam().nature.capacity_wh);
}

/// The controller is killed, and its clock stepped, after these numbers of control cycles.
TEST_P(HonestBattery, TripsNothingAmongKillsAndStepsOfTheClock) {
  // Slower than its map says: it may look wrong at times, but must not trip.
  const bool is_beyond_its_map = GetParam().name == std::string_view("ramp_30_w_per_s");
  const Disturbances cases[] = {{.kill_every = 1},
                                {.kill_every = 7},
                                {.kill_every = 2, .step_every = 3},
                                {.step_every = 3},
                                {.step_every = 11}};
  for (const Disturbances& often : std::span(cases).first(few_or_all(3, 5))) {
    const HonestDays days = live_honest_days(GetParam(), (kDays + 5) / 6, often);
    SCOPED_TRACE("killed after " + std::to_string(often.kill_every) + ", stepped after " +
                 std::to_string(often.step_every));
    EXPECT_EQ(days.trips, 0) << reason_name(days.first_trip) << " in cycle "
                             << days.first_trip_cycle;
    if (often.step_every == 0 || !is_beyond_its_map) {
      EXPECT_LT(days.wrong_energy_e6_max, WrongEnergy::kReportedE6);
    }
    EXPECT_GT(days.driven, days.cycles / (often.step_every == 0 ? 3 : 4));
  }
}

INSTANTIATE_TEST_SUITE_P(Variants, HonestBattery, ::testing::ValuesIn(honest_variants()),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace bess::trial
