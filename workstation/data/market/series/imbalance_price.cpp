#include "workstation/data/market/series/imbalance_price.h"

#include <algorithm>
#include <cmath>
#include <iterator>

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

std::vector<const PriceRegime*> regimes_met(const UtcSpan& span) {
  std::vector<const PriceRegime*> met;
  for (const PriceRegime* regime = std::begin(kPriceRegimes); regime != std::end(kPriceRegimes);
       ++regime) {
    const PriceRegime* const next = regime + 1;
    const bool begins_before = next == std::end(kPriceRegimes) || span.from_s < next->from_utc_s;
    if (span.until_s > regime->from_utc_s && begins_before) met.push_back(regime);
  }
  return met;
}

std::string regimes_not_learnt(const UtcSpan& learnt, const UtcSpan& traded) {
  const std::vector<const PriceRegime*> known = regimes_met(learnt);
  std::vector<const PriceRegime*> unknown = regimes_met(traded);
  std::erase_if(unknown,
                [&](const PriceRegime* r) { return std::ranges::find(known, r) != known.end(); });
  return regime_names(unknown);
}

std::string regime_names(const std::vector<const PriceRegime*>& regimes) {
  std::string names;
  for (const PriceRegime* regime : regimes) {
    names.append(names.empty() ? "" : ", ").append(regime->name);
  }
  return names;
}

}  // namespace bess
