// Walk-forward result of a run's chain, retrained before each traded month
// (report/backtest/walk_forward.h); and the table of students by omega.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/env/evaluate.h"

namespace bess {

// Trade-off omega [Paper, Eq. 12] as table and CSV: students of one teacher, distilled through the
// layer without repair, with violations, fidelity and profit by omega.

/// One student, on validation and test days, SoC carried over.
struct OmegaPoint {
  double omega;
  Certificate certificate;  ///< over all lattice states
  double divergence_nats;   ///< mean KL(student || teacher) on the teacher's training states
  double agreement;         ///< share of equal decisions of teacher and student
  Evaluation evaluation;
};

std::string format_omega_table(const std::vector<OmegaPoint>& points, const Evaluation& teacher);

/// Header `omega,violations_property_1,...`
std::string omega_csv(const std::vector<OmegaPoint>& points, const Evaluation& teacher);

/// Profit of the chain, SoC carried over; EUR per day per MWh of capacity.
struct WalkForwardFigure {
  double profit;
  DayErrors errors;
  std::string page;  ///< link to the backtest's page from the run's folder
};

/// Result, or the reason why there is none.
struct WalkForwardOfRun {
  std::optional<WalkForwardFigure> figure;
  std::string why_none;  ///< with the command to make one
};

/// As a sentence.
std::string walk_forward_text(const WalkForwardOfRun& walk_forward);
/// As escaped HTML, with a link to the backtest's page.
std::string walk_forward_html(const WalkForwardOfRun& walk_forward);
Json walk_forward_json(const WalkForwardFigure& figure);

}  // namespace bess
