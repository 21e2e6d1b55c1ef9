// bess-train rules: an operator's rules before anybody commits to them.
#include "workstation/cli/commands.h"

namespace bess {

void add_rules_commands(ProgramCommand& app) {
  ProgramCommand rules = app.subcommand(
      "rules", "Your own rules: whom they bind, who breaks them, what they cost and change");
  rules.requires_subcommand();
  add_rules_check(rules);
  add_rules_price(rules);
}

}  // namespace bess
