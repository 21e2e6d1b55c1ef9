#include "workstation/report/rule_prices.h"

#include <fmt/core.h>

#include <algorithm>

namespace bess {
namespace {

constexpr std::string_view kUnder = "plain student under ";

std::string price_line(const std::string& name, const HeadlineGain& gain) {
  std::string line = fmt::format("  {:<44}", name);
  for (const PairedDifference& d : gain.difference) {
    line += fmt::format("  {:>+8.1f} {:>6} {:>8}", d.mean, error_text(d.standard_error, 1),
                        error_text(d.standard_error_by_month, 1));
  }
  return line + "\n";
}

}  // namespace

const NamedEvaluation* carried_over_by(const std::vector<NamedEvaluation>& evaluations,
                                       std::string_view name) {
  const auto found = std::ranges::find(evaluations, name, &NamedEvaluation::name);
  return found == evaluations.end() || found->carried_over.days.empty() ? nullptr : &*found;
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
      .rules = {},
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

std::string rule_prices_text(const RulePrices& prices) {
  std::string text = fmt::format(
      "What the rules change, in EUR per day per MWh of capacity: the plain student's decisions "
      "moved to the\nnearest that they leave; what is left between that and the {} is {}\n"
      "  {:<44}  {:>8} {:>6} {:>8}  {:>8} {:>6} {:>8}\n",
      prices.student, prices.correction.meaning, "", "wear 0", "s.e.", "by month",
      fmt::format("wear {:g}", kHeadlineWears[1]), "s.e.", "by month");
  for (const HeadlineGain& rule : prices.rules) {
    text += price_line(fmt::format("rule \"{}\" alone", rule.meaning), rule);
  }
  return text + price_line("all rules together", prices.together) +
         price_line(prices.correction.meaning, prices.correction) +
         price_line("both", prices.total);
}

Json rule_prices_json(const RulePrices& prices) {
  Json list = Json::list();
  const auto add = [&](const char* part, const HeadlineGain& gain) {
    Json json = Json::object({{"part", part}});
    json.set("rule", part == std::string_view("rule") ? Json(gain.meaning) : Json::null());
    for (std::size_t w = 0; w < kHeadlineWears.size(); ++w) {
      const std::string key = fmt::format("at_wear_{:g}", kHeadlineWears[w]);
      json.set((key + "_eur_per_day_per_mwh").c_str(), Decimals{gain.difference[w].mean, 4});
      json.set((key + "_standard_error").c_str(), Decimals{gain.difference[w].standard_error, 4});
      json.set((key + "_standard_error_by_month").c_str(),
               Decimals{gain.difference[w].standard_error_by_month, 4});
    }
    list.add(std::move(json));
  };
  for (const HeadlineGain& rule : prices.rules) add("rule", rule);
  add("all rules", prices.together);
  add("correction", prices.correction);
  add("both", prices.total);
  return list;
}

}  // namespace bess
