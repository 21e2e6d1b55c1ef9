#include "workstation/planners/tabular.h"

#include <Eigen/Core>

#include <algorithm>
#include <cmath>

#include "shared/host/user_error.h"
#include "workstation/planners/soc_grid.h"

namespace bess {
namespace {

constexpr int kPhases = 15;
constexpr int kBins = 48;
constexpr int kSocPoints = 181;
constexpr double kPseudoCount = 0.001;
constexpr float kGamma = 0.999F;
/// 0.999^(15 * 400) = 0.0025: the value is within 0.3 % of its limit and the greedy action has
/// settled.
constexpr int kSweepsMax = 400;

using Values = Eigen::Matrix<float, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

}  // namespace

TabularPolicy::TabularPolicy(const MarketSteps& market, const std::vector<MarketDay>& days,
                             const BatteryParameters& battery)
    : battery_(battery) {
  require_training_days(days.size());
  count_market(market, days);
  iterate_values();
}

int TabularPolicy::price_bin(double price_eur_per_mwh) const {
  return static_cast<int>(std::ranges::upper_bound(bin_edges_, price_eur_per_mwh) -
                          bin_edges_.begin());
}

void TabularPolicy::count_market(const MarketSteps& market, const std::vector<MarketDay>& days) {
  std::vector<double> observed;
  for (const MarketDay& day : days) {
    for (const MarketStep& step : market.of(day)) observed.push_back(step.observed_eur_per_mwh);
  }
  std::ranges::sort(observed);
  for (int b = 1; b < kBins; ++b) {
    bin_edges_.push_back(observed[observed.size() * static_cast<std::size_t>(b) / kBins]);
  }
  std::vector<double> visits(kPhases * kBins, 0.0);
  std::vector<double> next(kPhases * kBins * kBins, kPseudoCount);
  import_.assign(kPhases * kBins, 0.0);
  export_.assign(kPhases * kBins, 0.0);
  for (const MarketDay& day : days) {
    const auto steps = market.of(day);
    for (std::size_t i = 0; i < steps.size(); ++i) {
      const int cell = steps[i].half_hour_phase * kBins + price_bin(steps[i].observed_eur_per_mwh);
      visits[cell] += 1;
      import_[cell] += battery_.costs.import_eur_per_mwh(steps[i].paid_eur_per_mwh);
      export_[cell] += battery_.costs.export_eur_per_mwh(steps[i].paid_eur_per_mwh);
      if (i + 1 < steps.size()) {
        next[cell * kBins + price_bin(steps[i + 1].observed_eur_per_mwh)] += 1;
      }
    }
  }
  transition_.resize(next.size());
  for (int cell = 0; cell < kPhases * kBins; ++cell) {
    if (visits[cell] > 0) {
      import_[cell] /= visits[cell];
      export_[cell] /= visits[cell];
    }
    double total = 0;
    for (int b = 0; b < kBins; ++b) total += next[cell * kBins + b];
    for (int b = 0; b < kBins; ++b) {
      transition_[cell * kBins + b] = static_cast<float>(next[cell * kBins + b] / total);
    }
  }
}

void TabularPolicy::iterate_values() {
  const SocGrid grid(battery_, kSocPoints);
  const std::vector<GridMove> moves = tabulate_moves(battery_, grid);
  const auto wear = static_cast<float>(battery_.wear_eur_per_mwh);
  std::vector<Values> value(kPhases, Values::Zero(kBins, kSocPoints));
  greedy_.assign(kPhases * kBins * kSocPoints, Action::kIdle);
  for (int sweep = 0; sweep < kSweepsMax; ++sweep) {
    for (int phase = kPhases - 1; phase >= 0; --phase) {
      const Eigen::Map<const Values> chain(&transition_[phase * kBins * kBins], kBins, kBins);
      const Values expected = kGamma * (chain * value[(phase + 1) % kPhases]);
      for (int b = 0; b < kBins; ++b) {
        const auto import_price = static_cast<float>(import_[phase * kBins + b]);
        const auto export_price = static_cast<float>(export_[phase * kBins + b]);
        for (int i = 0; i < kSocPoints; ++i) {
          float worth[kActionCount];
          for (int a = 0; a < kActionCount; ++a) {
            const GridMove& move = moves[a * kSocPoints + i];
            const float price = move.energy_mwh > 0 ? import_price : export_price;
            worth[a] = interpolate(expected.row(b).data(), move.next) - price * move.energy_mwh -
                       wear * std::fabs(move.energy_mwh);
          }
          const Action best = argmax_action(worth);
          value[phase](b, i) = worth[static_cast<int>(best)];
          greedy_[(phase * kBins + b) * kSocPoints + i] = best;
        }
      }
    }
  }
}

Action TabularPolicy::decide(const MarketStep& step, std::size_t, double soc_frac) const {
  const SocGrid grid(battery_, kSocPoints);
  const int cell = step.half_hour_phase * kBins + price_bin(step.observed_eur_per_mwh);
  return greedy_[cell * kSocPoints + grid.nearest(soc_frac)];
}

}  // namespace bess
