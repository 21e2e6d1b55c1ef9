// Log comparison: other policies in the same control cycles, with the controller's prices and their
// delay, from the same SoC.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/comparison.h"
#include "workstation/runs/log/log_input.h"

namespace bess {

inline constexpr const char* kThisBattery = "this battery";

/// This battery, `policies` and foresight; SoC carried over, final charge valued. A policy is
/// "rbc", "rbc:LOW:HIGH" or a name for student_for_log(). Throws UserError.
std::vector<NamedEvaluation> compare_log(const ReadLog& read,
                                         const std::vector<std::string>& policies);

/// Earnings of the whole battery over all days, EUR.
struct NetEarnings {
  double paid_eur;    ///< net of costs and wear
  double charge_eur;  ///< value of the final charge
};
NetEarnings net_earnings_of(const Evaluation& evaluation);

}  // namespace bess
