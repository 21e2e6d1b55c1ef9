// The rule file: commented TOML, one [[rule]] each (workstation/config/rules/ has examples). Keys:
//
//   name = "no dear charging"                  1 to 40 letters, digits, spaces or -_.,:()%+; unique
//   hours = "22:00-06:00"                      local, whole quarter-hours, the end excluded; past
//                                              midnight too
//   months = [11, 12, 1, 2]                    local; a student by price level is not bound by them
//   context_classes = [1, 2]                   of the price level, 1 the cheapest; not with months
//   soc_min = 0.1, soc_max = 0.3               fractions, multiples of 0.005, ends included
//   price_min = 301, price_max = 1000          whole EUR/MWh, -15000..15000, ends included
//   is | is_not | at_least | at_most = "idle"  one demand: the action; discharge < idle < charge
//   never_rises_with | never_falls_with = "price"   or: its direction; minute, quarter_hour,
//                                              context_class, soc, price
//   power_max = 0.5                            or: of the rated power; the guard's alone
//   charge_at_or_below | discharge_at_or_above = 0  or: a threshold of property 1 or 2, EUR/MWh
//   enforce = true                             by the guard too, whatever the student says
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/correction/rules/rule.h"

namespace bess {

/// So that a name fits into the edge's constant table, in comments and in log lines.
inline constexpr std::size_t kNameLengthMax = 40;

/// Throws UserError naming file, line, key and the mend; two rules of one name are an error too.
RuleSet parse_rules(std::string_view text, const std::string& name);
/// All rules of several files; none for no file.
RuleSet load_rules(const std::vector<std::string>& paths);

/// As a file that reads back to the same rules.
std::string format_rules(const RuleSet& rules);

}  // namespace bess
