// Allowed actions as linear constraints on the scores of one state [SPEC 5], u = z_charge - z_idle
// and v = z_idle - z_discharge:
//   at least charge  u >= m, v >= 0          at most discharge  -v >= m, -u >= 0
//   at least idle    v >= m                  at most idle       -u >= m
// Each is slightly stronger than necessary and separates u from v. "Not idle" is not convex: the
// constraint takes the side of the present scores.
#pragma once

#include <array>

#include "shared/decision_rule.h"

namespace bess {

/// on_u * u + on_v * v >= at_least.
struct ScoreRow {
  double on_u, on_v, at_least;
};

class ScoreRows {
 public:
  /// `u`, `v`: the present scores, used for "not idle" only.
  ScoreRows(ActionSet actions, double u, double v, double margin) {
    const bool discharges = allows(actions, Action::kDischarge);
    const bool idles = allows(actions, Action::kIdle);
    const bool charges = allows(actions, Action::kCharge);
    const bool has_gap = discharges && charges && !idles;
    const bool is_nearer_charge = u + v >= 0;
    const bool must_charge = has_gap ? is_nearer_charge : !discharges && !idles;
    const bool must_discharge = has_gap ? !is_nearer_charge : !charges && !idles;
    if (must_charge) {
      add({1, 0, margin});
      add({0, 1, 0});
    } else if (must_discharge) {
      add({0, -1, margin});
      add({-1, 0, 0});
    } else {
      if (!discharges) add({0, 1, margin});
      if (!charges) add({-1, 0, margin});
    }
  }
  [[nodiscard]] const ScoreRow* begin() const { return rows_.data(); }
  [[nodiscard]] const ScoreRow* end() const { return rows_.data() + count_; }

 private:
  void add(const ScoreRow& row) { rows_[count_++] = row; }
  std::array<ScoreRow, 2> rows_{};
  std::size_t count_ = 0;
};

}  // namespace bess
