// What a proof counted, as one list: the three properties and then the operator's rules, each by
// its name. Whatever tells of a proof, in lines, tables, JSON or CSV, goes through it.
#pragma once

#include <string>
#include <vector>

#include "workstation/student/certificate.h"

namespace bess {

struct DemandCount {
  std::string name;           ///< "property 1", or the rule's
  std::string text;           ///< what it asks, for people
  bool is_rule = false;       ///< else a property
  bool binds_student = true;  ///< false: the guard's alone, nothing was counted
  std::int64_t states = 0;    ///< states, or pairs of neighbours, that it was held against
  std::int64_t violations = 0;
  std::vector<Rule> rules = {};  ///< that it stands for: of property 3 two

  /// "property 1", or "rule \"quiet hours\"".
  [[nodiscard]] std::string label() const;
};

/// The properties, and all rules; of rules that nobody has looked at the counts are 0 and none
/// binds.
std::vector<DemandCount> demand_counts(const Certificate& certificate);

/// "property 3: 12, rule \"quiet hours\": 23994": what is broken; empty when nothing is.
std::string broken_text(const std::vector<DemandCount>& counts);

}  // namespace bess
