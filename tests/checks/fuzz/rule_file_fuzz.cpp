// Rule files of an operator.
#include "shared/host/user_error.h"
#include "tests/checks/fuzz/fuzz_target.h"
#include "workstation/correction/rules/rule.h"
#include "workstation/correction/rules/rule_conflicts.h"

int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace bess;
  std::string written;
  RuleSet rules;
  try {
    rules = parse_rules(text_of(data, size), "fuzz");
    written = format_rules(rules);
  } catch (const UserError&) {
    return 0;
  }
  must(format_rules(parse_rules(written, "written")) == written,
       "what is written reads back to the same");
  for (const ContextKind kind : {ContextKind::kMonth, ContextKind::kLevel}) {
    try {
      require_consistent(rules, {}, kind);
    } catch (const UserError&) {
      continue;
    }
    // A rule set that can be satisfied allows some action in every state.
    const ImpliedRanges implied(rules, kind);
    for (int n = 0; n < 200; ++n) {
      const int price = kLatticePriceMinEurPerMwh + n * 37 % kPriceCount;
      must(implied.at(n * 7 % kQuarterHourCount, 1 + n % 12, n * 13 % kSocCount, price) != 0,
           "some action is left");
    }
  }
  return 0;
}
