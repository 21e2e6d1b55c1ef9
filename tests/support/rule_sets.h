// Rules for tests, in the operator's format.
#pragma once

#include <string>

#include "workstation/correction/rules/rule.h"

namespace bess {

inline constexpr const char* kExampleRules[] = {"blackout_reserve", "no_charging_at_high_prices",
                                                "no_cheap_discharge", "quiet_hours",
                                                "evening_power_cap"};

inline std::string example_rule_path(const std::string& name) {
  return std::string(BESS_SOURCE_DIR) + "/workstation/config/rules/" + name + ".toml";
}

/// All shipped examples, in one set.
inline RuleSet example_rules() {
  std::vector<std::string> paths;
  for (const char* name : kExampleRules) paths.push_back(example_rule_path(name));
  return load_rules(paths);
}

/// One rule: its lines without the name.
inline RuleSet one_rule(const std::string& lines, const std::string& name = "it") {
  return parse_rules("[[rule]]\nname = \"" + name + "\"\n" + lines, "test.toml");
}

}  // namespace bess
