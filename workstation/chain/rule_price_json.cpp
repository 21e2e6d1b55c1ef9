#include "workstation/chain/rule_price_json.h"

#include "workstation/base/answer.h"

namespace bess {
namespace {

template <typename Whole>
Json whole_or_null(const std::optional<Whole>& number) {
  return number ? Json(*number) : Json::null();
}

void add_gain(const RuleGain& gain, bool carry_soc, Json& json) {
  json.set(key::kCarrySoc, carry_soc);
  json.set(key::kProfit, Decimals{gain.profit, 4});
  json.set("profit_without_rules_eur_per_day_per_mwh", Decimals{gain.without, 4});
  json.set(key::kGain, Decimals{gain.gain, 4});
  json.set(key::kGainError, Decimals{gain.gain_error, 4});
  json.set(key::kGainErrorByMonth, Decimals{gain.gain_error_by_month, 4});
  json.set("gain_deviation_over_seeds", Decimals{gain.spread, 4});
}

}  // namespace

Json rule_price_json(const RulePriceRow& row) {
  Json json = answer("rule_price");
  json.set("rule", row.rule);
  json.set("by", row.by);
  json.set(key::kGainOver, row.gain_over);
  json.set("split", row.split);
  json.set("days", row.days);
  json.set("seeds", whole_or_null(row.seeds));
  json.set("states_checked", whole_or_null(row.states_checked));
  json.set("violations", whole_or_null(row.violations));
  json.set("proved", whole_or_null(row.proved));
  json.set("rounds", whole_or_null(row.rounds));
  json.set("seconds_per_student", Decimals{row.seconds_per_student, 1});
  json.set("share_of_decisions_changed", Decimals{row.changed_share, 6});
  add_gain(row.reset, false, json);
  Json carried = Json::object();
  add_gain(row.carried, true, carried);
  json.set(key::kCarriedOver, std::move(carried));
  return json;
}

}  // namespace bess
