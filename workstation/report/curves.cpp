#include "workstation/report/curves.h"

#include <fmt/format.h>

#include <algorithm>

namespace bess {

std::string training_curve_csv(const std::vector<CurvePoint>& curve) {
  std::string text = "step,loss,validation_eur_per_day_per_mwh,edge_mass_frac\n";
  for (const CurvePoint& p : curve) {
    text += fmt::format("{},{:.6g},{:.4f},{:.6g}\n", p.step, p.loss,
                        p.validation_eur_per_day_per_mwh, p.edge_mass_frac);
  }
  return text;
}

std::string distil_curve_csv(const std::vector<DistilPoint>& curve) {
  std::string text = "epoch,teacher_loss,correction_loss,visited_loss\n";
  for (const DistilPoint& p : curve) {
    text += fmt::format("{},{:.6g},{:.6g},{:.6g}\n", p.epoch, p.teacher_loss, p.correction_loss,
                        p.visited_loss);
  }
  return text;
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
