#include "workstation/rl/program_residual.h"

#include <algorithm>

#include "shared/exchange_cost.h"
#include "workstation/rl/transition.h"

namespace bess {

ProgramRows::ProgramRows(std::shared_ptr<const StochasticProgram> program)
    : program_(std::move(program)),
      grid_(program_->battery(), StochasticProgram::kSocPoints),
      unit_per_eur_(learned_per_eur(program_->battery())) {}

std::uint32_t ProgramRows::add(const MarketStep& step) {
  if (step.utc_s != last_utc_s_) {
    const auto at = StochasticProgram::situation_of(step);
    continuation_.resize(continuation_.size() + StochasticProgram::kSocPoints);
    program_->continuation(at, &*(continuation_.end() - StochasticProgram::kSocPoints));
    price_eur_per_mwh_.push_back(program_->expected_price(at));
    last_utc_s_ = step.utc_s;
  }
  return static_cast<std::uint32_t>(price_eur_per_mwh_.size() - 1);
}

ProgramRows::Values ProgramRows::at(std::uint32_t row, double soc_frac) const {
  const BatteryParameters& battery = program_->battery();
  const float* ahead = &continuation_[std::size_t{row} * StochasticProgram::kSocPoints];
  Values values{};
  for (int a = 0; a < kActionCount; ++a) {
    const double wanted_w = power_sign(static_cast<Action>(a)) * battery.power_w_max;
    const BatteryStep moved = battery_step(battery, soc_frac, wanted_w, kHoursPerStep);
    const double cost_eur = exchange_cost_eur(
        battery, moved.power_w / kWattsPerMegawatt * kHoursPerStep, price_eur_per_mwh_[row]);
    const double worth_eur = double{interpolate(ahead, grid_.position(moved.soc_frac))} - cost_eur;
    values.action[a] = static_cast<float>(worth_eur * unit_per_eur_);
  }
  values.best = *std::ranges::max_element(values.action);
  return values;
}

}  // namespace bess
