#include "workstation/report/figures/policy_map.h"

#include "workstation/rl/network_input.h"
#include "workstation/student/verify.h"

namespace bess {
namespace {

std::size_t cell(int soc, int price) {
  return static_cast<std::size_t>(soc) * kPriceCount + static_cast<std::size_t>(price);
}

/// Runs of `action` in one row become rectangles, or lengthen those of the row below.
void add_row(const ActionGrid& grid, Action action, int soc, std::vector<GridRectangle>& open,
             std::vector<GridRectangle>& closed) {
  std::vector<GridRectangle> row;
  for (int p = 0; p < kPriceCount; ++p) {
    if (grid[cell(soc, p)] != static_cast<std::int8_t>(action)) continue;
    if (row.empty() || row.back().price_last != p - 1) row.push_back({p, p, soc, soc});
    row.back().price_last = p;
  }
  for (const GridRectangle& below : open) {
    bool continued = false;
    for (GridRectangle& run : row) {
      if (run.price_first != below.price_first || run.price_last != below.price_last) continue;
      run.soc_bottom = below.soc_bottom;
      continued = true;
    }
    if (!continued) closed.push_back(below);
  }
  open = std::move(row);
}

/// Lengthens the last border when this pair follows it directly.
void add_pair(const WrongBorder& pair, std::vector<WrongBorder>& borders) {
  if (!borders.empty()) {
    WrongBorder& last = borders.back();
    const std::int64_t next = (pair.along_price ? last.price : last.soc) + last.pairs;
    const bool follows = pair.along_price ? last.soc == pair.soc && next == pair.price
                                          : last.price == pair.price && next == pair.soc;
    if (last.along_price == pair.along_price && follows) {
      ++last.pairs;
      return;
    }
  }
  borders.push_back(pair);
}

}  // namespace

ActionGrid teacher_grid(const Teacher& teacher, const PolicyContext& context) {
  ActionGrid grid(static_cast<std::size_t>(kSocCount * kPriceCount));
  Matrix x(kNetworkInputs, kPriceCount);
  MlpTile tile;
  for (int soc = 0; soc < kSocCount; ++soc) {
    for (int p = 0; p < kPriceCount; ++p) {
      const float mapped = teacher.price_map(kLatticePriceMinEurPerMwh + p);
      write_input(network_context(context.minute_of_quarter_hour, context.quarter_hour,
                                  context.context_class, mapped),
                  static_cast<double>(soc) / (kSocCount - 1), x.col(p).data());
    }
    const Matrix values = teacher.action_values(x, tile);
    for (int p = 0; p < kPriceCount; ++p) {
      grid[cell(soc, p)] = static_cast<std::int8_t>(argmax_action(values.col(p).data()));
    }
  }
  return grid;
}

ActionGrid student_grid(const StudentNet& net, const PolicyContext& context) {
  ActionGrid grid;
  fill_action_grid(net, context.minute_of_quarter_hour, context.quarter_hour, context.context_class,
                   false, grid);
  return grid;
}

std::vector<GridRectangle> rectangles_of(const ActionGrid& grid, Action action) {
  std::vector<GridRectangle> open, closed;
  for (int soc = 0; soc < kSocCount; ++soc) {
    add_row(grid, action, soc, open, closed);
    for (GridRectangle& run : open) run.soc_top = soc;
  }
  closed.insert(closed.end(), open.begin(), open.end());
  return closed;
}

std::vector<RuleOutline> rule_outlines(const RuleSet& rules, ContextKind kind,
                                       const PolicyContext& context) {
  std::vector<RuleOutline> outlines;
  for (const Rule& rule : rules.rules) {
    if (rule.demand->pairs_along() || !binds_student(rule, kind)) continue;
    if (!holds_in_context(rule.box, kind, context.quarter_hour, context.context_class)) continue;
    const LatticeBox box = lattice_box_of(rule.box, kind);
    outlines.push_back({rule.name, {box.price_first, box.price_last, box.soc_first, box.soc_last}});
  }
  return outlines;
}

std::vector<WrongBorder> wrong_borders_of(const ActionGrid& grid) {
  std::vector<WrongBorder> borders;
  for (int soc = 0; soc + 1 < kSocCount; ++soc) {
    for (int p = 0; p < kPriceCount; ++p) {
      if (grid[cell(soc + 1, p)] > grid[cell(soc, p)]) add_pair({p, soc, true}, borders);
    }
  }
  for (int p = 0; p + 1 < kPriceCount; ++p) {
    for (int soc = 0; soc < kSocCount; ++soc) {
      if (grid[cell(soc, p + 1)] > grid[cell(soc, p)]) add_pair({p, soc, false}, borders);
    }
  }
  return borders;
}

}  // namespace bess
