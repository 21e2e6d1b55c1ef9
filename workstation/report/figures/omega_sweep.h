// The paper's trade-off omega [Paper, Eq. 12] as table and CSV: students distilled through
// the layer from one teacher, each with its own omega and before any repair, so that what a larger
// omega costs in violations is seen, and what it brings in fidelity and money.
#pragma once

#include <string>
#include <vector>

#include "workstation/env/evaluate.h"
#include "workstation/student/certificate.h"

namespace bess {

/// One student. Days are those of validation and test, SoC carried over.
struct OmegaPoint {
  double omega;
  Certificate certificate;  ///< of all lattice states
  double divergence_nats;  ///< KL(student || teacher) where the teacher goes on training days, mean
  double agreement;  ///< share of the teacher's decisions on the days that are the student's too
  Evaluation evaluation;
};

std::string format_omega_table(const std::vector<OmegaPoint>& points, const Evaluation& teacher);

/// Header `omega,violations_property_1,...`
std::string omega_csv(const std::vector<OmegaPoint>& points, const Evaluation& teacher);

}  // namespace bess
