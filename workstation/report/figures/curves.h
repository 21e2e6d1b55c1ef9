// Learning and distillation curves as CSV, out and back in, and the smoothing that their figures
// show.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/correction/distil.h"
#include "workstation/rl/train.h"

namespace bess {

/// Neighbours on either side of a validation profit that its smoothed value is the mean of.
inline constexpr int kSmoothingReach = 2;

std::string training_curve_csv(const std::vector<CurvePoint>& curve);
std::string distil_curve_csv(const std::vector<DistilPoint>& curve);

/// Mean over each point and up to `reach` neighbours on either side.
std::vector<double> centred_mean(const std::vector<double>& values, int reach);

/// Read back what the writers wrote; throw UserError naming `name` and the line otherwise.
std::vector<CurvePoint> parse_training_curve_csv(std::string_view text, std::string_view name);
std::vector<DistilPoint> parse_distil_curve_csv(std::string_view text, std::string_view name);

}  // namespace bess
