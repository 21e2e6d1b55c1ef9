#include "workstation/rl/potential.h"

#include <algorithm>
#include <array>
#include <memory>
#include <vector>

#include "workstation/planners/rolling_horizon.h"
#include "workstation/planners/stochastic_program.h"

namespace bess {
namespace {

constexpr int kPlanStride = 2;

Potential price_potential(const MarketSteps& market, const BatteryParameters& battery) {
  double sum_eur_per_mwh = 0;
  double count = 0;
  for (const MarketDay& day : market.days_of(Split::kTrain)) {
    for (const MarketStep& step : market.of(day)) {
      // Half-way between what it costs to store and what it earns to sell: so neither looks free.
      sum_eur_per_mwh += 0.5 * (battery.costs.import_eur_per_mwh(step.paid_eur_per_mwh) +
                                battery.costs.export_eur_per_mwh(step.paid_eur_per_mwh));
    }
    count += static_cast<double>(day.step_count);
  }
  const double window_mwh =
      (battery.soc_max_frac - battery.soc_min_frac) * battery.capacity_wh / 1e6;
  const auto full_eur = static_cast<float>(sum_eur_per_mwh / count * window_mwh);
  return {.soc_points = 2, .fill = [full_eur](const MarketStep&, float* phi) {
            phi[0] = 0;
            phi[1] = full_eur;
          }};
}

/// Of a plan whose `values` writes `points` of them: every other point is enough.
template <int points, typename Values>
Potential potential_of_plan(Values values) {
  return {.soc_points = (points - 1) / kPlanStride + 1,
          .fill = [values](const MarketStep& step, float* phi) {
            std::array<float, points> all;
            values(step, all.data());
            for (int i = 0; i < points; i += kPlanStride) *phi++ = all[static_cast<std::size_t>(i)];
          }};
}

Potential plan_potential(const MarketSteps& market, const BatteryParameters& battery) {
  const auto plan =
      std::make_shared<RollingHorizonPolicy>(market, market.days_of(Split::kTrain), battery);
  return potential_of_plan<RollingHorizonPolicy::kSocPoints>(
      [plan](const MarketStep& step, float* values) {
        std::ranges::copy(plan->values(step), values);
      });
}

Potential program_potential(const MarketSteps& market, const BatteryParameters& battery) {
  const auto program =
      std::make_shared<StochasticProgram>(market, market.days_of(Split::kTrain), battery);
  return potential_of_plan<StochasticProgram::kSocPoints>(
      [program](const MarketStep& step, float* values) {
        program->values(StochasticProgram::situation_of(step), values);
      });
}

}  // namespace

Potential fit_potential(PotentialKind kind, const MarketSteps& market,
                        const BatteryParameters& battery) {
  switch (kind) {
    case PotentialKind::kPrice:
      return price_potential(market, battery);
    case PotentialKind::kPlan:
      return plan_potential(market, battery);
    case PotentialKind::kSdp:
      return program_potential(market, battery);
    case PotentialKind::kNone:
      break;
  }
  return {};
}

double mean_of(const Potential& potential, const MarketSteps& market) {
  std::vector<float> phi(static_cast<std::size_t>(potential.soc_points));
  const std::size_t middle = phi.size() / 2;
  double sum = 0;
  double count = 0;
  for (const MarketDay& day : market.days_of(Split::kTrain)) {
    for (const MarketStep& step : market.of(day)) {
      potential.fill(step, phi.data());
      sum += phi.size() % 2 == 1 ? phi[middle] : 0.5F * (phi[middle - 1] + phi[middle]);
      count += 1;
    }
  }
  return sum / count;
}

}  // namespace bess
