#include "workstation/policy/planners/outlook_program.h"

#include <algorithm>
#include <cmath>

#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr int kBins = OutlookModel::kBins;
static_assert(DeviationChain::kBins == 2 * kBins &&
              DeviationChain::kPhases == OutlookModel::kPhases);

std::int32_t scaled(double value, int bits) {
  return static_cast<std::int32_t>(std::lround(std::ldexp(value, bits)));
}
std::int32_t centi(double eur) {
  return static_cast<std::int32_t>(std::lround(eur * kCentiPerEur));
}

/// Rounds shares to a sum of one; the largest takes the difference.
void set_shares(const double (&share)[kBins], std::int32_t (&row)[kBins]) {
  std::int32_t left = 1 << OutlookModel::kProbabilityBits;
  for (int n = 0; n < kBins; ++n) left -= row[n] = scaled(share[n], OutlookModel::kProbabilityBits);
  *std::ranges::max_element(row) += left;
}

void set_chain(const DeviationChain& chain, OutlookModel& model) {
  for (int b = 0; b < kBins; ++b) {
    model.bin_centi[b] = centi(0.5 * (chain.centre(2 * b) + chain.centre(2 * b + 1)));
  }
  for (int phase = 0; phase < OutlookModel::kPhases; ++phase) {
    const float* transition = chain.transition(phase);
    for (int b = 0; b < kBins; ++b) {
      model.paid_centi[phase][b] =
          centi(0.5 * (chain.paid(phase, 2 * b) + chain.paid(phase, 2 * b + 1)));
      double share[kBins] = {};
      for (int from = 2 * b; from < 2 * b + 2; ++from) {
        for (int to = 0; to < DeviationChain::kBins; ++to) {
          share[to / 2] += 0.5 * double{transition[from * DeviationChain::kBins + to]};
        }
      }
      set_shares(share, model.transition_q15[phase][b]);
    }
  }
}

void set_battery(const BatteryParameters& battery, OutlookModel& model) {
  const double energy = battery.power_w_max / battery.capacity_wh * kHoursPerStep;
  const double points =
      (OutlookModel::kSocPoints - 1) / (battery.soc_max_frac - battery.soc_min_frac);
  model.soc_min_e4 = static_cast<std::int32_t>(std::lround(battery.soc_min_frac * kSocFullE4));
  model.soc_max_e4 = static_cast<std::int32_t>(std::lround(battery.soc_max_frac * kSocFullE4));
  model.charge_q24 = model.discharge_q24 = scaled(energy, OutlookModel::kEnergyBits);
  model.charge_points_q15 =
      scaled(energy * battery.charge_efficiency * points, OutlookModel::kPointBits);
  model.discharge_points_q15 =
      scaled(energy / battery.discharge_efficiency * points, OutlookModel::kPointBits);
  const TradingCosts& costs = battery.costs;
  model.import_centi = centi(costs.import_adder_eur_per_mwh + battery.wear_eur_per_mwh);
  model.export_centi = centi(costs.export_fee_eur_per_mwh + battery.wear_eur_per_mwh);
  model.import_share_q12 = scaled(costs.import_percent / 100, OutlookModel::kCoefficientBits);
  model.export_share_q12 = scaled(costs.export_percent / 100, OutlookModel::kCoefficientBits);
}

}  // namespace

OutlookModel outlook_integers(const OutlookProgram& program) {
  OutlookModel model;
  const OutlookProgram::Coefficients& c = program.coefficients();
  model.constant_centi = centi(c.constant);
  model.day_ahead_q12 = scaled(c.day_ahead, OutlookModel::kCoefficientBits);
  model.level_q12 = scaled(c.level, OutlookModel::kCoefficientBits);
  model.lasting_q12 = scaled(c.lasting, OutlookModel::kCoefficientBits);
  model.row_age_min = program.row_age_min();
  for (std::size_t q = 0; q < kQuarterHourCount; ++q) {
    model.hour_centi[q] = centi(c.hour * program.hour()[q]);
    model.day_ahead_mean_centi[q] = centi(program.day_ahead_mean()[q]);
  }
  model.discount_q15 = scaled(program.gamma(), OutlookModel::kProbabilityBits);
  set_chain(program.chain(), model);
  set_battery(program.battery(), model);
  if (!model.is_sound()) {
    fail(
        "the plan on day-ahead prices does not fit into its integers: prices beyond 20,000 "
        "EUR/MWh, or coefficients beyond 8");
  }
  return model;
}

}  // namespace bess
