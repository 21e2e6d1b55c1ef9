#include "workstation/correction/rules/demand.h"

namespace bess {

// Each is in the NAME_demand.cpp of its name.
DemandKind action_kind();
DemandKind direction_kind();
DemandKind power_kind();
DemandKind threshold_kind();

/// Every kind of demand, in the order in which error messages list the keys.
std::span<const DemandKind> demand_kinds() {
  static const DemandKind kKinds[] = {action_kind(), direction_kind(), power_kind(),
                                      threshold_kind()};
  return kKinds;
}

}  // namespace bess
