#include <fmt/core.h>

#include "workstation/report/headline.h"

namespace bess {
namespace {

constexpr std::string_view kUnder = "plain student under ";

/// One rule, all rules, the correction, or both.
struct Part {
  const char* kind;
  const HeadlineGain* gain;
  [[nodiscard]] bool is_rule() const { return kind == std::string_view("rule"); }
};

}  // namespace

const NamedEvaluation* carried_over_by(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name) {
  const NamedEvaluation* found = find_evaluation(evaluations, name);
  return found == nullptr || found->carried_over.days.empty() ? nullptr : found;
}

std::string under_rule_name(const std::string& rule) {
  return fmt::format("{}\"{}\"", kUnder, rule);
}

bool is_under_rules(std::string_view policy) { return policy.starts_with(kUnder); }

std::optional<RulePrices> rule_prices_of(const std::vector<NamedEvaluation>& evaluations) {
  const NamedEvaluation* plain = carried_over_by(evaluations, kPlainName);
  const NamedEvaluation* under_all = carried_over_by(evaluations, kUnderAllRules);
  const NamedEvaluation* exported = find_own_student(evaluations);
  if (plain == nullptr || under_all == nullptr || exported == nullptr) return std::nullopt;
  const bool is_finished = exported->name == kCorrectedName;
  RulePrices prices{
      .student = exported->name,
      .together = gain_over(*under_all, *plain, "all rules together"),
      .correction = gain_over(*exported, *under_all,
                              is_finished ? "the correction" : "the unfinished correction"),
      .total = gain_over(*exported, *plain, "both")};
  for (const NamedEvaluation& named : evaluations) {
    if (!is_under_rules(named.name) || named.name == kUnderAllRules) continue;
    const std::string quoted = named.name.substr(kUnder.size());
    prices.rules.push_back(gain_over(named, *plain, quoted.substr(1, quoted.size() - 2)));
  }
  return prices;
}

Table rule_prices_table(const RulePrices& prices) {
  using P = Part;
  std::vector<P> parts;
  for (const HeadlineGain& rule : prices.rules) parts.push_back({"rule", &rule});
  parts.push_back({"all rules", &prices.together});
  parts.push_back({"correction", &prices.correction});
  parts.push_back({"both", &prices.total});
  Table table{{Column<P>{{"part"}, &P::kind},
               {{"rule"}, [](const P& p) { return p.is_rule() ? p.gain->meaning : ""; }},
               {{"", "change against the plain student", "", 0, "Change against the plain student"},
                [](const P& p) { return p.gain->meaning + (p.is_rule() ? ", alone" : ""); }}},
              parts};
  for (std::size_t w = 0; w < kHeadlineWears.size(); ++w) {
    const std::string key = fmt::format("at_wear_{:g}", kHeadlineWears[w]);
    const std::string wear = fmt::format("wear {:g}", kHeadlineWears[w]);
    table.add<P>({{key + "_eur_per_day_per_mwh", wear, "{:+.1f}", 4},
                  [w](const P& p) { return p.gain->difference[w].mean; }},
                 parts);
    table.add<P>({{key + "_standard_error", "s.e.", "{:.1f}", 4},
                  [w](const P& p) { return p.gain->difference[w].errors.plain; }},
                 parts);
    table.add<P>({{key + "_standard_error_by_month", "by month", "{:.1f}", 4},
                  [w](const P& p) { return p.gain->difference[w].errors.by_month; }},
                 parts);
    table.add<P>({{"", "", "", 0, "W" + wear.substr(1) + ", EUR/day/MWh"},
                  [w](const P& p) { return difference_text(p.gain->difference[w]); }},
                 parts);
  }
  return table;
}

std::string rule_prices_text(const RulePrices& prices) {
  return fmt::format(
      "Effect of the rules, EUR per day per MWh of capacity: decisions of the plain student are "
      "moved to\nthe nearest allowed ones; the difference to the {} is {}\n{}",
      prices.student, prices.correction.meaning, rule_prices_table(prices).text());
}

}  // namespace bess
