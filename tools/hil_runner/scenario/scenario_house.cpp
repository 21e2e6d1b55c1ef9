#include "tools/hil_runner/scenario/scenario_house.h"

#include <fmt/core.h>

#include <cmath>

#include "shared/utc_text.h"

namespace bess {

std::string house_csv(const Scenario& scenario) {
  constexpr int kMinutesAround = 60;
  const auto& steps = scenario.house.steps;
  std::string text = "minute_utc,house_w\n";
  const int end = static_cast<int>(std::ceil(scenario.minutes)) + kMinutesAround;
  for (int minute = -kMinutesAround; minute < end; ++minute) {
    double power_w = steps.front().power_w;
    for (const ScenarioHouse::Step& step : steps) {
      if (step.from_min <= minute) power_w = step.power_w;
    }
    text += fmt::format("{},{}\n", utc_text(scenario.start_utc_s + 60 * minute).view(), power_w);
  }
  return text;
}

HouseLoad house_load(const Scenario& scenario) {
  if (scenario.house.seed) return HouseLoad::daily(*scenario.house.seed);
  return HouseLoad::from_csv(house_csv(scenario), scenario.name);
}

}  // namespace bess
