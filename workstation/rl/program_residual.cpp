#include "workstation/rl/program_residual.h"

#include <algorithm>

#include "shared/exchange_cost.h"
#include "workstation/rl/transition.h"

namespace bess {
namespace {

constexpr int kSocPoints = StochasticProgram::kSocPoints;
static_assert(kSocPoints == OutlookProgram::kSocPoints);

}  // namespace

ProgramRows::ProgramRows(Foundation foundation)
    : foundation_(std::move(foundation)),
      grid_(foundation_.battery(), kSocPoints),
      break_even_grid_(foundation_.battery(), OutlookModel::kSocPoints),
      unit_per_eur_(learned_per_eur(foundation_.battery())) {}

std::uint32_t ProgramRows::add(const MarketStep& step) {
  if (step.utc_s != last_utc_s_) {
    continuation_.resize(continuation_.size() + kSocPoints);
    float* const value_eur = &*(continuation_.end() - kSocPoints);
    if (is_outlook()) {
      add_outlook(step, value_eur);
    } else {
      const auto at = StochasticProgram::situation_of(step);
      foundation_.program->continuation(at, value_eur);
      price_eur_per_mwh_.push_back(foundation_.program->expected_price(at));
    }
    last_utc_s_ = step.utc_s;
  }
  return static_cast<std::uint32_t>(price_eur_per_mwh_.size() - 1);
}

void ProgramRows::add_outlook(const MarketStep& step, float* value_eur) {
  begins_plan_.push_back(!plan_.serves(step));
  if (begins_plan_.back()) plan_ = foundation_.outlook->plan_of(step);
  price_eur_per_mwh_.push_back(foundation_.outlook->continuation(step, plan_, value_eur));
  for (int p = 0; p < break_even_grid_.count; ++p) {
    break_even_.push_back(
        static_cast<float>(foundation_.book->break_even_centi(step, break_even_grid_.at(p))) /
        kCentiPerEur);
  }
}

double ProgramRows::break_even(std::uint32_t row, double soc_frac) const {
  const auto count = static_cast<std::size_t>(break_even_grid_.count);
  return double{interpolate(&break_even_[row * count], break_even_grid_.position(soc_frac))};
}

ProgramRows::Values ProgramRows::at(std::uint32_t row, double soc_frac) const {
  const BatteryParameters& battery = foundation_.battery();
  const float* ahead = &continuation_[std::size_t{row} * kSocPoints];
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
