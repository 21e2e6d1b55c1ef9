#include "workstation/policy/rl/network_input.h"

#include <algorithm>
#include <cmath>

#include "shared/host/user_error.h"
#include "shared/nn/student_net.h"

namespace bess {
namespace {

/// Number of quantiles, joined linearly: enough for the distribution, too few for noise.
constexpr int kQuantileCount = 64;

/// Piecewise-linear cumulative distribution through evenly spaced quantiles of sorted data.
double smooth_cdf(const std::vector<double>& knots, double price) {
  if (price <= knots.front()) return 0;
  if (price >= knots.back()) return 1;
  const auto upper = std::ranges::upper_bound(knots, price) - knots.begin();
  const double low = knots[upper - 1];
  const double width = knots[upper] - low;
  return (static_cast<double>(upper - 1) + (price - low) / width) /
         static_cast<double>(knots.size() - 1);
}

}  // namespace

PriceMap PriceMap::fit(const std::vector<double>& observed_eur_per_mwh) {
  if (observed_eur_per_mwh.empty()) fail("no observed prices on training days; add some");
  std::vector<double> sorted = observed_eur_per_mwh;
  std::ranges::sort(sorted);
  std::vector<double> knots;
  for (int q = 0; q <= kQuantileCount; ++q) {
    const double price = sorted[(sorted.size() - 1) * static_cast<std::size_t>(q) / kQuantileCount];
    if (knots.empty() || price > knots.back()) knots.push_back(price);
  }
  std::array<std::int16_t, kPriceCount> table;
  for (int i = 0; i < kPriceCount; ++i) {
    const double price = kLatticePriceMinEurPerMwh + i;
    const double line = static_cast<double>(i) / (kPriceCount - 1);
    const double x = 0.5 * line + 0.5 * smooth_cdf(knots, price);
    table[i] = static_cast<std::int16_t>(std::lround(x * kInputOne));
  }
  return PriceMap(table);
}

PriceMap::PriceMap(const std::array<std::int16_t, kPriceCount>& table) : table_(table) {
  for (int i = 0; i < kPriceCount; ++i) {
    if (table[i] < 0 || (i > 0 && table[i] <= table[i - 1])) {
      fail("price map does not increase strictly at {} EUR/MWh; the file is damaged",
           kLatticePriceMinEurPerMwh + i);
    }
  }
}

float PriceMap::operator()(double price_eur_per_mwh) const {
  const double x = std::clamp(price_eur_per_mwh - kLatticePriceMinEurPerMwh, 0.0,
                              static_cast<double>(kPriceCount - 1));
  const int i = std::min(static_cast<int>(x), kPriceCount - 2);
  const double y = table_[i] + (x - i) * (table_[i + 1] - table_[i]);
  return static_cast<float>(y / kInputOne);
}

double PriceMap::price_of(float input) const {
  const double wanted = double{input} * kInputOne;
  const auto above = std::ranges::upper_bound(table_, wanted);
  const auto upper = std::clamp<std::ptrdiff_t>(above - table_.begin(), 1, kPriceCount - 1);
  const double low = table_[upper - 1];
  const double high = table_[upper];
  const double weight = std::clamp((wanted - low) / (high - low), 0.0, 1.0);
  return kLatticePriceMinEurPerMwh + static_cast<double>(upper) - 1 + weight;
}

}  // namespace bess
