#include "workstation/correction/lattice_rule_rows.h"

#include <cmath>

#include "shared/nn/student_net.h"
#include "workstation/correction/rule_rows.h"

namespace bess {
namespace {

void add_rows(const Rule& rule, int state, double margin, std::vector<DifferenceRow>& rows) {
  for (const ScoreRow& row : ScoreRows(rule.actions, 0, 0, margin)) {  // of a set without a gap
    DifferenceRow added{rule.name, {}, row.at_least};
    if (row.on_u != 0) added.terms.push_back({state, Difference::kU, row.on_u});
    if (row.on_v != 0) added.terms.push_back({state, Difference::kV, row.on_v});
    rows.push_back(std::move(added));
  }
}

}  // namespace

std::vector<DifferenceRow> lattice_rule_rows(const RuleSet& rules, ContextKind kind,
                                             const LatticeState& context, const LatticeAxes& axes,
                                             double margin) {
  std::vector<DifferenceRow> rows;
  const auto socs = static_cast<int>(axes.soc.size());
  for (const Rule& rule : rules.rules) {
    if (rule.demand != Demand::kActions || rule.has_gap() || !binds_student(rule, kind) ||
        !holds_in_context(rule.box, kind, context.quarter_hour, context.context_class)) {
      continue;
    }
    const LatticeBox box = lattice_box_of(rule.box, kind);
    for (int i = 0; i < static_cast<int>(axes.price_eur_per_mwh.size()); ++i) {
      const int price = axes.price_eur_per_mwh[i] - kLatticePriceMinEurPerMwh;
      if (price < box.price_first || price > box.price_last) continue;
      for (int j = 0; j < socs; ++j) {
        const auto soc = static_cast<int>(std::lround(axes.soc[j] * kInputOne / kSocScale));
        if (soc < box.soc_first || soc > box.soc_last) continue;
        add_rows(rule, i * socs + j, margin, rows);
      }
    }
  }
  return rows;
}

}  // namespace bess
