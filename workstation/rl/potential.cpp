#include "workstation/rl/potential.h"

#include <array>
#include <memory>
#include <vector>

#include "workstation/planners/stochastic_program.h"

namespace bess {
namespace {

constexpr int kStride = 2;

/// Every other point of the program's is enough.
Potential program_potential(const MarketSteps& market, const BatteryParameters& battery) {
  constexpr int kPoints = StochasticProgram::kSocPoints;
  const auto program =
      std::make_shared<StochasticProgram>(market, market.days_of(Split::kTrain), battery);
  return {.soc_points = (kPoints - 1) / kStride + 1,
          .fill = [program](const MarketStep& step, float* phi) {
            std::array<float, kPoints> all;
            program->values(StochasticProgram::situation_of(step), all.data());
            for (int i = 0; i < kPoints; i += kStride) *phi++ = all[static_cast<std::size_t>(i)];
          }};
}

}  // namespace

Potential fit_potential(PotentialKind kind, const MarketSteps& market,
                        const BatteryParameters& battery) {
  return kind == PotentialKind::kSdp ? program_potential(market, battery) : Potential{};
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
