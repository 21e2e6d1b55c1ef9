// What other policies would have earned in the cycles of a log, beside what the battery earned:
// each decides on the price that the controller had there, with its delay, from the same charge on.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/comparison.h"
#include "workstation/runs/log/log_input.h"

namespace bess {

inline constexpr const char* kThisBattery = "this battery";

/// This battery, `policies`, foresight; SoC carried over, the charge left valued. A policy is
/// "rbc", "rbc:LOW:HIGH", or what student_for_log() takes. Throws UserError.
std::vector<NamedEvaluation> compare_log(const ReadLog& read,
                                         const std::vector<std::string>& policies);

/// Of the whole battery, over all days, EUR.
struct Paid {
  double paid_eur;    ///< net of costs and wear
  double charge_eur;  ///< the charge left at the end, as money
};
Paid paid_of(const Evaluation& evaluation);

}  // namespace bess
