// The walk-forward figure beside that of a run: what its chain would have earned had it been
// retrained before each month it traded, so that it saw no later one
// (report/backtest/walk_forward.h). And the table of students over omega.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/correction/student/certificate.h"
#include "workstation/data/env/day_errors.h"
#include "workstation/data/env/evaluate.h"

namespace bess {

// The paper's trade-off omega [Paper, Eq. 12] as table and CSV: students distilled through
// the layer from one teacher, each with its own omega and before any repair, so that what a larger
// omega costs in violations is seen, and what it brings in fidelity and money.

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

/// Of the whole chain, SoC carried over; EUR per day per MWh of capacity.
struct WalkForwardFigure {
  double profit;
  DayErrors errors;
  std::string page;  ///< the backtest's, as a link from the run's folder
};

/// There is one, or there is none and why.
struct WalkForwardOfRun {
  std::optional<WalkForwardFigure> figure;
  std::string why_none;  ///< and how to make one
};

/// A sentence for people.
std::string walk_forward_text(const WalkForwardOfRun& walk_forward);
/// The same, escaped, with a link to the backtest's page.
std::string walk_forward_html(const WalkForwardOfRun& walk_forward);
Json walk_forward_json(const WalkForwardFigure& figure);

}  // namespace bess
