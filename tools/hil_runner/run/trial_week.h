// The trial week: what the loop around the student costs. Eight days of a minute file, 5,760
// cycles, in virtual time, with delay, missing data, temperature and the battery's response
// switched on one at a time and together, each against the plain simulation of the same days:
// student, guard and battery model alone. Several weeks are paired: what differs is the loop, not
// the prices.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "tools/hil_runner/judge/judge.h"

namespace bess {

inline constexpr int kTrialDays = 8;

/// What is switched on.
struct Disturbance {
  const char* name;
  const char* text;
  bool delay = false;
  bool missing = false;
  bool outages = false;
  bool temperature = false;
  bool response = false;
};
inline constexpr int kDisturbanceCount = 7;
const std::array<Disturbance, kDisturbanceCount>& disturbances();

/// EUR of a house battery of 4 kW and 8 kWh over eight days; what is left in the battery at the end
/// counts at the week's mean price.
struct TrialWeek {
  std::int64_t start_utc_s = 0;
  double plain_eur = 0;
  std::array<double, kDisturbanceCount> loop_eur{};
  std::vector<Finding> findings;  ///< broken invariants of any of them
};

/// Mean loss of one disturbance against the plain simulation, over the weeks, with the standard
/// error of the paired difference; in percent of the plain simulation's mean.
struct TrialLoss {
  double percent = 0;
  double percent_error = 0;
};

/// The house battery, of which plain simulation and loop know the same: the paper's, with constant
/// power.
BatteryParameters paper_house();

struct TrialHouse {
  BatteryParameters physics = paper_house();
  std::string edge_guard;                       ///< lines of [guard], of the loop alone
  int outage_min = 60, outage_every_min = 720;  ///< how long, and one within each so many
};

/// Calls `tell(weeks done, weeks in all)` after each. Throws UserError when the file holds fewer
/// weeks.
std::vector<TrialWeek> run_trial(const MinuteSeries& prices, int weeks, const TrialHouse& house,
                                 const std::function<void(int, int)>& tell);
TrialLoss loss_of(const std::vector<TrialWeek>& weeks, std::size_t disturbance);

/// The first week with everything on: four hours of its largest price range as a picture (SVG).
std::string trial_picture(const MinuteSeries& prices, const TrialHouse& house);

}  // namespace bess
