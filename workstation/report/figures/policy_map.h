// A policy seen as a map: its action at every lattice price and SoC of one month and time of day,
// and where that map breaks the order of property 3 [Paper, Eq. 11].
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <vector>

#include "shared/nn/student_net.h"
#include "workstation/rl/teacher.h"
#include "workstation/rules/rule.h"

namespace bess {

/// The part of a state that stays fixed over one map.
struct PolicyContext {
  int context_class;           ///< 1..12
  int quarter_hour;            ///< local, 0..95
  int minute_of_quarter_hour;  ///< minute of the quarter-hour, 0..14
  friend auto operator<=>(const PolicyContext&, const PolicyContext&) = default;
};

/// Action's integers, [SoC index][price index], kSocCount x kPriceCount.
using ActionGrid = std::vector<std::int8_t>;

ActionGrid teacher_grid(const Teacher& teacher, const PolicyContext& context);
ActionGrid student_grid(const StudentNet& net, const PolicyContext& context);

/// Cells of one action: price indices first..last and SoC indices bottom..top, inclusive.
struct GridRectangle {
  int price_first, price_last, soc_bottom, soc_top;
};
/// Covers exactly the cells with `action`, each once.
std::vector<GridRectangle> rectangles_of(const ActionGrid& grid, Action action);

/// A border between neighbours at which the action increases with price or with SoC.
struct WrongBorder {
  int price, soc;          ///< lower cell of the first pair
  bool along_price;        ///< true: the pairs are (SoC, SoC + 1), side by side in price
  std::int64_t pairs = 1;  ///< neighbour pairs that it joins
};
std::vector<WrongBorder> wrong_borders_of(const ActionGrid& grid);

/// The boxes of the rules that bind a student of this kind in this context, by name; directions
/// have none.
struct RuleOutline {
  std::string name;
  GridRectangle box;
};
std::vector<RuleOutline> rule_outlines(const RuleSet& rules, ContextKind kind,
                                       const PolicyContext& context);

struct NamedPolicyMap {
  std::string name;
  ActionGrid grid;
};

}  // namespace bess
