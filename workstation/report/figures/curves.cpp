#include "workstation/report/figures/curves.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "shared/host/csv.h"
#include "workstation/data/market/statistics/market_statistics.h"

namespace bess {

namespace {

constexpr double kShownTail = 0.005;  ///< omitted on either side

std::vector<double> sorted_observed(const MarketSteps& market, Split split) {
  std::vector<double> prices =
      market.prices_of(market.days_of(split), &MarketStep::observed_eur_per_mwh);
  std::ranges::sort(prices);
  return prices;
}

constexpr std::string_view kTrainingHeader =
    "step,loss,validation_eur_per_day_per_mwh,validation_smoothed,edge_mass_frac,"
    "gain_at_least_eur_per_day_per_mwh";
constexpr std::string_view kDistilHeader = "epoch,teacher_loss,correction_loss,visited_loss";

/// Rows of `kColumns` numbers under a known header; may be empty.
template <std::size_t kColumns>
std::vector<std::array<double, kColumns>> parse_rows(std::string_view text, std::string_view header,
                                                     std::string_view name) {
  std::vector<std::array<double, kColumns>> rows;
  if (text == fmt::format("{}\n", header)) return rows;
  const CsvTable table(text, std::string(name), header);
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    std::array<double, kColumns> values{};
    for (std::size_t i = 0; i < kColumns; ++i) values[i] = table.number(row, i);
    rows.push_back(values);
  }
  return rows;
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

PictureFile histogram_file(const PriceHistogram& shown) {
  const std::vector<double> train = shown.percent_by_bin(shown.train);
  const std::vector<double> test = shown.percent_by_bin(shown.test);
  std::string csv = "from_eur_per_mwh,training_days_percent,test_days_percent\n";
  for (std::size_t b = 0; b < train.size(); ++b) {
    const double from = shown.low + static_cast<double>(b) * kPriceBinEurPerMwh;
    csv += fmt::format("{:g},{},{}\n", from, exact(train[b]), exact(test[b]));
  }
  return {"prices_seen.csv", std::move(csv)};
}

std::string training_curve_csv(const std::vector<CurvePoint>& curve) {
  std::vector<double> profit;
  for (const CurvePoint& p : curve) profit.push_back(p.validation_eur_per_day_per_mwh);
  const std::vector<double> smoothed = centred_mean(profit, kSmoothingReach);
  std::string text = fmt::format("{}\n", kTrainingHeader);
  for (std::size_t i = 0; i < curve.size(); ++i) {
    const CurvePoint& p = curve[i];
    text += fmt::format("{},{:.6g},{:.4f},{:.4f},{:.6f},{:.6g}\n", p.step, p.loss, profit[i],
                        smoothed[i], p.edge_mass_frac, p.gain_at_least_eur_per_day_per_mwh);
  }
  return text;
}

std::string distil_curve_csv(const std::vector<DistilPoint>& curve) {
  std::string text = fmt::format("{}\n", kDistilHeader);
  for (const DistilPoint& p : curve) {
    text += fmt::format("{},{:.6g},{:.6g},{:.6g}\n", p.epoch, p.teacher_loss, p.correction_loss,
                        p.visited_loss);
  }
  return text;
}

std::vector<CurvePoint> parse_training_curve_csv(std::string_view text, std::string_view name) {
  std::vector<CurvePoint> curve;
  for (const auto& row : parse_rows<6>(text, kTrainingHeader, name)) {
    curve.push_back({static_cast<long>(row[0]), row[1], row[2], row[4], row[5]});
  }
  return curve;
}

std::vector<DistilPoint> parse_distil_curve_csv(std::string_view text, std::string_view name) {
  std::vector<DistilPoint> curve;
  for (const auto& row : parse_rows<4>(text, kDistilHeader, name)) {
    curve.push_back({static_cast<int>(row[0]), row[1], row[2], row[3]});
  }
  return curve;
}

std::vector<double> centred_mean(const std::vector<double>& values, int reach) {
  std::vector<double> smoothed;
  const int count = static_cast<int>(values.size());
  for (int i = 0; i < count; ++i) {
    const int first = std::max(0, i - reach);
    const int last = std::min(count - 1, i + reach);
    double sum = 0;
    for (int k = first; k <= last; ++k) sum += values[static_cast<std::size_t>(k)];
    smoothed.push_back(sum / (last - first + 1));
  }
  return smoothed;
}

}  // namespace bess
