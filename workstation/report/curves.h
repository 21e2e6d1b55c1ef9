// Learning and distillation curves as CSV, and the smoothing that their figures show.
#pragma once

#include <string>
#include <vector>

#include "workstation/correction/distil.h"
#include "workstation/rl/train.h"

namespace bess {

/// Header `step,loss,validation_eur_per_day_per_mwh,edge_mass_frac`.
std::string training_curve_csv(const std::vector<CurvePoint>& curve);
/// Header `epoch,teacher_loss,correction_loss,visited_loss`.
std::string distil_curve_csv(const std::vector<DistilPoint>& curve);

/// Mean over each point and up to `reach` neighbours on either side.
std::vector<double> centred_mean(const std::vector<double>& values, int reach);

}  // namespace bess
