#include "workstation/market/series/imbalance_price.h"

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

constexpr double kAlphaDeadBandMw = 150;
constexpr double kAlphaMaxEurPerMwh = 200;
constexpr double kAlphaCentreMw = 450;
constexpr double kAlphaWidthMw = 65;

/// 1 up to MIP = 200 (down to MDP = 0), falling linearly to 0 at MIP = 400 (MDP = -200).
double tempering(const ImbalanceState& state) {
  const double room = is_short(state.system_imbalance_mw)
                          ? 400 - state.marginal_incremental_eur_per_mwh
                          : 200 + state.marginal_decremental_eur_per_mwh;
  return std::clamp(room / 200, 0.0, 1.0);
}

}  // namespace

double alpha_eur_per_mwh(const ImbalanceState& state) {
  const double size_mw = std::abs(state.system_imbalance_mw);
  if (size_mw <= kAlphaDeadBandMw) return 0;
  const double x_mw = (size_mw + std::abs(state.previous_system_imbalance_mw)) / 2;
  const double logistic = 1 / (1 + std::exp((kAlphaCentreMw - x_mw) / kAlphaWidthMw));
  return tempering(state) * kAlphaMaxEurPerMwh * logistic;
}

double imbalance_price_eur_per_mwh(const ImbalanceState& state) {
  return imbalance_price_eur_per_mwh(state, alpha_eur_per_mwh(state));
}

}  // namespace bess
