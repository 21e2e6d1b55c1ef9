#include "workstation/report/figures/policy_map.h"

#include "workstation/student/verify.h"

namespace bess {

ActionGrid student_grid(const StudentNet& net, const PolicyContext& context) {
  ActionGrid grid;
  fill_action_grid(net, context.minute_of_quarter_hour, context.quarter_hour, context.context_class,
                   false, grid);
  return grid;
}

}  // namespace bess
