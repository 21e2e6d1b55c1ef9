// Rule file: commented TOML, one [[rule]] each (examples: workstation/config/rules/). Keys:
//
//   name = "no dear charging"                  1 to 40 letters, digits, spaces or -_.,:()%+; unique
//   hours = "22:00-06:00"                      local, whole quarter-hours, the end excluded; may
//                                              span midnight
//   months = [11, 12, 1, 2]                    local; binds only students with the month context
//   context_classes = [1, 2]                   of the price level, 1 the lowest; not with months
//   soc_min = 0.1, soc_max = 0.3               fractions, multiples of 0.005, ends included
//   price_min = 301, price_max = 1000          whole EUR/MWh, -15000..15000, ends included
//   is | is_not | at_least | at_most = "idle"  one demand: the action; discharge < idle < charge
//   never_rises_with | never_falls_with = "price"   or: its direction; minute, quarter_hour,
//                                              context_class, soc, price
//   power_max = 0.5                            or: share of the rated power; guard only
//   charge_at_or_below | discharge_at_or_above = 0  or: a threshold of property 1 or 2, EUR/MWh
//   enforce = true                             by the guard too
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/correction/rules/rule.h"

namespace bess {

/// Limit of the edge's constant table, comments and log lines.
inline constexpr std::size_t kNameLengthMax = 40;

/// Throws UserError naming file, line, key and remedy; names must be unique.
RuleSet parse_rules(std::string_view text, const std::string& name);
/// All rules of several files; empty without files.
RuleSet load_rules(const std::vector<std::string>& paths);

/// Text of a rule file that parses to the same rules.
std::string format_rules(const RuleSet& rules);

}  // namespace bess
