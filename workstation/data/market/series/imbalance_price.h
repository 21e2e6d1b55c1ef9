// Elia's imbalance price formula until 21 May 2024 (tariff of the balancing services; datasets
// ods046 and ods047 publish every term):
//   price = MIP + alpha   if SI < 0        MIP, MDP  marginal incremental / decremental price
//   price = MDP - alpha   if SI >= 0       SI        system imbalance, negative = Belgium is short
//   alpha = 0             if |SI| <= 150 MW
//   alpha = cp * 200 / (1 + exp((450 - x) / 65)) otherwise, with x = (|SI| + |SI_prev|) / 2; cp
//           tempers alpha when MIP is already high (short) or MDP already low (long), see the
//           source
// Verified on the 13,650 quarter-hours of 1 January to 23 May 2023 of ods047: the price agrees
// within 0.015 EUR/MWh in all, alpha within 0.02 in all but one of those with a predecessor.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "shared/training_period.h"

namespace bess {

struct ImbalanceState {
  double system_imbalance_mw;           ///< of the quarter-hour, or of its part so far
  double previous_system_imbalance_mw;  ///< of the whole preceding quarter-hour
  double marginal_incremental_eur_per_mwh;
  double marginal_decremental_eur_per_mwh;
};

/// Belgium short: upward regulation sets the price.
constexpr bool is_short(double system_imbalance_mw) { return system_imbalance_mw < 0; }

/// The additional component alpha, never negative.
double alpha_eur_per_mwh(const ImbalanceState& state);
/// Price with the given alpha.
inline double imbalance_price_eur_per_mwh(const ImbalanceState& state, double alpha_eur_per_mwh) {
  return is_short(state.system_imbalance_mw)
             ? state.marginal_incremental_eur_per_mwh + alpha_eur_per_mwh
             : state.marginal_decremental_eur_per_mwh - alpha_eur_per_mwh;
}
double imbalance_price_eur_per_mwh(const ImbalanceState& state);

// Price regimes (shared/training_period.h) of a period.

/// The end is excluded.
struct UtcSpan {
  std::int64_t from_s, until_s;
};

/// Regimes that overlap the span, in order.
std::vector<const PriceRegime*> regimes_met(const UtcSpan& span);

/// Names of the regimes of `traded` that are not in `learnt`, or empty.
std::string regimes_not_learnt(const UtcSpan& learnt, const UtcSpan& traded);

/// Names, separated by commas.
std::string regime_names(const std::vector<const PriceRegime*>& regimes);

}  // namespace bess
