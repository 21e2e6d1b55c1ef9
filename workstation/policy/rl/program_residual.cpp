#include "workstation/policy/rl/teacher.h"

#include <algorithm>
#include <cmath>

#include "shared/battery_model.h"
#include "workstation/base/parallel_for.h"

namespace bess {
namespace {

constexpr int kSocPoints = StochasticProgram::kSocPoints;
static_assert(kSocPoints == OutlookProgram::kSocPoints);

}  // namespace

ProgramRows::ProgramRows(BasePrograms base_programs, const MarketSteps& market,
                         const std::vector<MarketDay>& days, int threads)
    : base_programs_(std::move(base_programs)),
      grid_(base_programs_.battery(), kSocPoints),
      break_even_grid_(base_programs_.battery(), OutlookModel::kSocPoints),
      unit_per_eur_(learned_per_eur(base_programs_.battery())) {
  std::vector<std::size_t> first_row;
  for (const MarketDay& day : days) {
    first_row.push_back(utc_s_.size());
    for (const MarketStep& step : market.of(day)) utc_s_.push_back(step.utc_s);
  }
  continuation_.resize(utc_s_.size() * kSocPoints);
  price_eur_per_mwh_.resize(utc_s_.size());
  full_power_w_.resize(utc_s_.size());
  if (is_outlook()) {
    break_even_.resize(utc_s_.size() * static_cast<std::size_t>(break_even_grid_.count));
    begins_plan_.resize(utc_s_.size());
  }
  parallel_for(days.size(), threads,
               [&](std::size_t d) { fill_day(market.of(days[d]), first_row[d]); });
}

void ProgramRows::fill_day(std::span<const MarketStep> steps, std::size_t row) {
  OutlookProgram::Plan plan;
  for (const MarketStep& step : steps) {
    float* const ahead = &continuation_[row * kSocPoints];
    full_power_w_[row] = base_programs_.battery().power_w_at(step.quarter_hour);
    if (is_outlook()) {
      begins_plan_[row] = plan.serves(step) ? 0 : 1;
      if (begins_plan_[row] != 0) plan = base_programs_.outlook->plan_of(step);
      price_eur_per_mwh_[row] = base_programs_.outlook->continuation(step, plan, ahead);
      fill_break_even(step, row);
    } else {
      price_eur_per_mwh_[row] =
          base_programs_.program->continuation(StochasticProgram::market_state_of(step), ahead);
    }
    ++row;
  }
}

void ProgramRows::fill_break_even(const MarketStep& step, std::size_t row) {
  const OutlookModel& model = base_programs_.plan_cache->model();
  const auto integers = base_programs_.plan_cache->plan_for(step);
  const auto points = static_cast<std::size_t>(break_even_grid_.count);
  for (std::size_t p = 0; p < points; ++p) {
    const double soc_frac = break_even_grid_.at(static_cast<int>(p));
    const auto soc_e4 = static_cast<std::int32_t>(std::lround(soc_frac * kSocFullE4));
    break_even_[row * points + p] = static_cast<float>(integers->break_even_centi(
                                        model, step.utc_s, soc_e4, step.level_centi_eur_per_mwh)) /
                                    kCentiPerEur;
  }
}

std::uint32_t ProgramRows::row_of(const MarketStep& step) const {
  return static_cast<std::uint32_t>(std::ranges::lower_bound(utc_s_, step.utc_s) - utc_s_.begin());
}

double ProgramRows::break_even(std::uint32_t row, double soc_frac) const {
  const auto count = static_cast<std::size_t>(break_even_grid_.count);
  return double{interpolate(&break_even_[row * count], break_even_grid_.position(soc_frac))};
}

ProgramRows::Values ProgramRows::at(std::uint32_t row, double soc_frac) const {
  const BatteryParameters& battery = base_programs_.battery();
  const float* ahead = &continuation_[std::size_t{row} * kSocPoints];
  Values values{};
  for (int a = 0; a < kActionCount; ++a) {
    const double wanted_w = power_sign(static_cast<Action>(a)) * full_power_w_[row];
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
