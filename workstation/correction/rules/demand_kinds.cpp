
#include "workstation/correction/rules/demand.h"

#include <array>

/// Every kind of demand, in the order in which error messages list the keys. NAME_kind() is in
/// NAME_demand.cpp.
#define BESS_DEMAND_KINDS(ROW) \
  ROW(action)                  \
  ROW(direction)               \
  ROW(power)                   \
  ROW(threshold)

namespace bess {

#define BESS_DECLARE(name) DemandKind name##_kind();
BESS_DEMAND_KINDS(BESS_DECLARE)
#undef BESS_DECLARE

std::span<const DemandKind> demand_kinds() {
#define BESS_LIST(name) name##_kind(),
  static const auto kKinds = std::to_array<DemandKind>({BESS_DEMAND_KINDS(BESS_LIST)});
#undef BESS_LIST
  return kKinds;
}

}  // namespace bess
