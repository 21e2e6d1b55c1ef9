#include "workstation/report/figures/curves.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>

#include "shared/host/csv.h"

namespace bess {
namespace {

constexpr std::string_view kTrainingHeader =
    "step,loss,validation_eur_per_day_per_mwh,validation_smoothed,edge_mass_frac,"
    "gain_at_least_eur_per_day_per_mwh";
constexpr std::string_view kDistilHeader = "epoch,teacher_loss,correction_loss,visited_loss";

/// Rows of `kColumns` numbers under a known header; none for a run that was over before its first
/// point.
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
