#include "workstation/report/figures/price_histogram.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "workstation/market/statistics/market_statistics.h"

namespace bess {
namespace {

constexpr double kShownTail = 0.005;  ///< left out on either side

std::vector<double> sorted_observed(const MarketSteps& market, Split split) {
  std::vector<double> prices;
  for (const MarketDay& day : market.days_of(split)) {
    for (const MarketStep& step : market.of(day)) prices.push_back(step.observed_eur_per_mwh);
  }
  std::ranges::sort(prices);
  return prices;
}

}  // namespace

std::vector<double> PriceHistogram::percent_by_bin(const std::vector<double>& sorted) const {
  std::vector<double> percent;
  const auto total = static_cast<double>(std::max<std::size_t>(1, sorted.size()));
  const auto bins = static_cast<int>((high - low) / kPriceBinEurPerMwh) + 1;
  for (int bin = 0; bin < bins; ++bin) {
    const double edge = low + bin * kPriceBinEurPerMwh;
    const auto count = std::ranges::lower_bound(sorted, edge + kPriceBinEurPerMwh) -
                       std::ranges::lower_bound(sorted, edge);
    percent.push_back(100.0 * static_cast<double>(count) / total);
  }
  return percent;
}

double PriceHistogram::percent_outside(const std::vector<double>& sorted) const {
  if (sorted.empty()) return 0;
  double inside = 0;
  for (const double percent : percent_by_bin(sorted)) inside += percent;
  return std::max(0.0, 100 - inside);
}

PriceHistogram price_histogram(const MarketSteps& market) {
  PriceHistogram histogram{sorted_observed(market, Split::kTrain),
                           sorted_observed(market, Split::kTest), 0, 0};
  for (const auto* prices : {&histogram.train, &histogram.test}) {
    if (prices->empty()) continue;
    histogram.low = std::min(histogram.low, quantile_of_sorted(*prices, kShownTail));
    histogram.high = std::max(histogram.high, quantile_of_sorted(*prices, 1 - kShownTail));
  }
  histogram.low = std::floor(histogram.low / kPriceBinEurPerMwh) * kPriceBinEurPerMwh;
  histogram.high =
      std::ceil(histogram.high / kPriceBinEurPerMwh) * kPriceBinEurPerMwh + kPriceBinEurPerMwh;
  return histogram;
}

PictureTable histogram_table(const std::string& name, const PriceHistogram& shown) {
  const std::vector<double> train = shown.percent_by_bin(shown.train);
  const std::vector<double> test = shown.percent_by_bin(shown.test);
  PictureTable table{name, {"from_eur_per_mwh", "training_days_percent", "test_days_percent"}, {}};
  for (std::size_t b = 0; b < train.size(); ++b) {
    const double from = shown.low + static_cast<double>(b) * kPriceBinEurPerMwh;
    table.rows.push_back({fmt::format("{:g}", from), exact(train[b]), exact(test[b])});
  }
  return table;
}

}  // namespace bess
