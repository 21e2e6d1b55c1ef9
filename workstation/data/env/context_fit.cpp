#include "workstation/data/env/context_fit.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "shared/host/user_error.h"

namespace bess {
namespace {

/// Half-range of the classes around the mean level of the training days, in standard deviations.
constexpr double kReachDeviations = 3;
constexpr int kEdges = kContextClassCount - 1;

}  // namespace

ContextKind parse_context(std::string_view name) {
  for (const ContextKind kind : kContextKinds) {
    if (name == context_name(kind)) return kind;
  }
  fail("unknown context \"{}\": use level, month or outlook", name);
}

ContextClasses fit_context_classes(const MarketSteps& market, ContextKind kind) {
  ContextClasses classes{.kind = kind};
  if (kind == ContextKind::kMonth) return classes;
  if (kind == ContextKind::kOutlook) {
    fail("classes of the outlook belong to a student: pass its file with --policy");
  }
  const std::vector<MarketDay> training = market.days_of(Split::kTrain);
  require_training_days(training.size());
  double count = 0;
  double sum = 0;
  double squares = 0;
  for_each_step(market, training, [&](const MarketStep& step) {
    const double level = step.level_eur_per_mwh();
    count += 1;
    sum += level;
    squares += level * level;
  });
  const double mean = sum / count;
  const double deviation = std::sqrt(std::max(0.0, squares / count - mean * mean));
  const int width =
      std::max(1, static_cast<int>(std::lround(2 * kReachDeviations * deviation / kEdges)));
  for (int e = 0; e < kEdges; ++e) {
    classes.level_edge_eur_per_mwh[e] =
        static_cast<std::int16_t>(std::lround(mean) + width * (2 * e + 1 - kEdges) / 2);
  }
  return classes;
}

ContextClasses fit_outlook_classes(const MarketSteps& market, const PlanCache& plan_cache) {
  const std::vector<MarketDay> training = market.days_of(Split::kTrain);
  require_training_days(training.size());
  const double low_frac = static_cast<double>(plan_cache.model().soc_min_e4) / kSocFullE4;
  const double width_frac =
      static_cast<double>(plan_cache.model().soc_max_e4) / kSocFullE4 - low_frac;
  std::vector<std::int32_t> prices_centi;
  std::size_t drawn = 0;
  for_each_step(market, training, [&](const MarketStep& step) {
    constexpr std::size_t kStride = 37;  // coprime: every SoC with every hour
    const auto soc = static_cast<double>(drawn++ * kStride % kSocCount) / (kSocCount - 1);
    prices_centi.push_back(plan_cache.break_even_centi(step, low_frac + soc * width_frac));
  });
  std::ranges::sort(prices_centi);
  ContextClasses classes{.kind = ContextKind::kOutlook};
  for (int e = 0; e < kEdges; ++e) {
    const std::size_t at = prices_centi.size() * static_cast<std::size_t>(e + 1) / (kEdges + 1);
    const int least = e == 0 ? INT16_MIN : classes.level_edge_eur_per_mwh[e - 1] + 1;
    const auto edge = static_cast<int>(std::lround(prices_centi[at] / double{kCentiPerEur}));
    classes.level_edge_eur_per_mwh[e] = static_cast<std::int16_t>(std::max(least, edge));
  }
  return classes;
}

double class_level_eur_per_mwh(const ContextClasses& classes, int context_class) {
  const auto& edge = classes.level_edge_eur_per_mwh;
  const double width = edge[1] - edge[0];
  if (context_class == 1) return edge[0] - width / 2;
  return edge[context_class - 2] + width / 2;
}

std::string context_text(const ContextClasses& classes, int context_class) {
  constexpr const char* kMonths[] = {"January",   "February", "March",    "April",
                                     "May",       "June",     "July",     "August",
                                     "September", "October",  "November", "December"};
  if (classes.kind == ContextKind::kMonth) return fmt::format("in {}", kMonths[context_class - 1]);
  const char* const what = classes.is_outlook() ? "break-even price" : "price level";
  const auto& edge = classes.level_edge_eur_per_mwh;
  if (context_class == 1) return fmt::format("at a {} below {} EUR/MWh", what, edge[0]);
  if (context_class == kContextClassCount) {
    return fmt::format("at a {} from {} EUR/MWh on", what, edge[context_class - 2]);
  }
  return fmt::format("at a {} from {} to {} EUR/MWh", what, edge[context_class - 2],
                     edge[context_class - 1]);
}

}  // namespace bess
