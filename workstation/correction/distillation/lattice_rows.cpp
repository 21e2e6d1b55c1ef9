#include "workstation/correction/distillation/distil.h"

#include <algorithm>
#include <cmath>

#include "shared/nn/student_net.h"
#include "workstation/correction/distillation/constraint_layer.h"

namespace bess {
namespace {

/// Row builder, rule by rule.
class RowMaker {
 public:
  RowMaker(const LatticeAxes& axes, const CorrectionOptions& options)
      : axes_(axes),
        options_(options),
        prices_(static_cast<int>(axes.price_eur_per_mwh.size())),
        socs_(static_cast<int>(axes.soc.size())),
        u_(ramped_bounds(options, axes, options.logit_margin, 0)),
        v_(ramped_bounds(options, axes, 0, -options.logit_margin)) {}

  void add_box(const Rule& rule, const LatticeBox& box) {
    for (int i = 0; i < prices_; ++i) {
      const int price = axes_.price_eur_per_mwh[i] - kLatticePriceMinEurPerMwh;
      for (int j = 0; j < socs_; ++j) {
        const auto nearest = static_cast<int>(std::lround(axes_.soc[j] * kInputOne / kSocScale));
        const int soc = std::clamp(nearest, 0, kSocCount - 1);
        if (box.contains(soc, price)) add_state(rule, i, j);
      }
    }
  }

  /// Rows for "the action never rises". The slope margin keeps the order despite integer rounding.
  void add_falls(const Rule& rule, RuleInput along) {
    const bool by_price = along == RuleInput::kPrice;
    const std::vector<double>& axis = by_price ? axes_.mapped_price : axes_.soc;
    const double slope = by_price ? options_.price_slope : options_.soc_slope;
    for (int i = 0; i + (by_price ? 1 : 0) < prices_; ++i) {
      for (int j = 0; j + (by_price ? 0 : 1) < socs_; ++j) {
        const int state = i * socs_ + j;
        const int next = state + (by_price ? socs_ : 1);
        const int k = by_price ? i : j;
        const double bound = slope * (axis[k + 1] - axis[k]);
        for (const Difference which : {Difference::kU, Difference::kV}) {
          rows_.push_back({rule.name, {{state, which, 1}, {next, which, -1}}, bound});
        }
      }
    }
  }

  /// The layer's order of the properties: its last bits depend on it.
  void sort_by_state() {
    std::ranges::stable_sort(rows_, {}, [](const DifferenceRow& row) {
      return std::pair(row.terms.front().difference, row.terms.front().state);
    });
  }

  std::vector<DifferenceRow> take() { return std::move(rows_); }

 private:
  void add_state(const Rule& rule, int i, int j) {
    const int state = i * socs_ + j;
    // For a set without a gap the scores do not matter.
    for (const ScoreRow& row : ScoreRows(rule.actions(), 0, 0, options_.logit_margin)) {
      const Difference which = row.on_u != 0 ? Difference::kU : Difference::kV;
      const double factor = row.on_u + row.on_v;
      const double bound =
          rule.property == 0 ? row.at_least : built_in_bound(which, factor > 0, i, j);
      rows_.push_back({rule.name, {{state, which, factor}}, bound});
    }
  }

  /// A property's bound leaves room for the slopes up to every state behind it.
  [[nodiscard]] double built_in_bound(Difference which, bool is_lower, int i, int j) const {
    const RowBounds& bounds = which == Difference::kU ? u_ : v_;
    const double ramp =
        options_.price_slope * axes_.mapped_price[i] + options_.soc_slope * axes_.soc[j];
    return is_lower ? bounds.lower - ramp : ramp - bounds.upper;
  }

  const LatticeAxes& axes_;
  const CorrectionOptions& options_;
  int prices_;
  int socs_;
  RowBounds u_, v_;
  std::vector<DifferenceRow> rows_;
};

}  // namespace

std::vector<DifferenceRow> lattice_rows(const RuleSet& rules, ContextKind kind,
                                        const LatticeState& context, const LatticeAxes& axes,
                                        const CorrectionOptions& options) {
  RowMaker maker(axes, options);
  for (const Rule& rule : rules.rules) {
    if (!binds_student(rule, kind) ||
        !holds_in_context(rule.box, kind, context.quarter_hour, context.context_class)) {
      continue;
    }
    if (rule.has_rows()) maker.add_box(rule, lattice_box_of(rule.box, kind));
    const Direction direction = rule.demand->direction();
    const bool in_lattice =
        direction.input == RuleInput::kPrice || direction.input == RuleInput::kSoc;
    if (rule.property != 0 && direction.sign < 0 && in_lattice) {
      maker.add_falls(rule, direction.input);
    }
  }
  if (!rules.empty() && rules.rules.front().property != 0) maker.sort_by_state();
  return maker.take();
}

std::vector<DifferenceRow> property_rows(const CorrectionOptions& options,
                                         const LatticeAxes& axes) {
  return lattice_rows(built_in_rules(options.thresholds), ContextKind::kMonth,
                      lattice_context(0, 0, 1), axes, options);
}

}  // namespace bess
