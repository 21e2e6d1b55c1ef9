#include "edge/page/decision_map.h"

#include "edge/control/policy.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

double eur(std::int32_t centi) { return static_cast<double>(centi) / kCentiPerEur; }

}  // namespace

DecisionMap make_decision_map(LatticeState at, const PriceThresholds& thresholds, Policy policy) {
  DecisionMap map;
  for (int i = 0; i < kSocCount; ++i) {
    at.soc_index = static_cast<std::int16_t>(i);
    const Margins margins = find_margins(at, 0, thresholds, policy);
    map.columns[static_cast<std::size_t>(i)] = {margins.charge_up_to_centi,
                                                margins.discharge_from_centi};
  }
  return map;
}

Json decision_map_json(const DecisionMap& map) {
  Json columns = Json::list();
  for (int i = 0; i < kSocCount; ++i) {
    const DecisionMap::Column& column = map.columns[static_cast<std::size_t>(i)];
    columns.add(Json::object(
        {{"soc_percent", Decimals{100.0 * i / (kSocCount - 1), 1}},
         {"charge_up_to_eur_per_mwh", Decimals{eur(column.charge_up_to_centi), 2}},
         {"discharge_from_eur_per_mwh", Decimals{eur(column.discharge_from_centi), 2}}}));
  }
  return Json::object({{"columns", std::move(columns)}});
}

Json decision_map_of(JsonValue why) {
  const auto whole = [](JsonValue value, std::int32_t otherwise) {
    return static_cast<std::int32_t>(value.number().value_or(otherwise));
  };
  std::int64_t utc_s = 0;
  const std::int32_t context = whole(why["context_class"], 0);
  const bool is_decided = why["margins"].is_object() && parse_utc(why["utc"].text_or(""), utc_s) &&
                          context >= 1 && context <= kContextClassCount;
  if (!is_decided || why["is_other_student"].boolean().value_or(true)) {
    return Json::object({{"columns", Json::list()}});
  }
  PriceThresholds thresholds;
  const JsonValue set = why["thresholds"];
  thresholds.low_eur_per_mwh =
      whole(set["charge_at_or_below_eur_per_mwh"], thresholds.low_eur_per_mwh);
  thresholds.high_eur_per_mwh =
      whole(set["discharge_at_or_above_eur_per_mwh"], thresholds.high_eur_per_mwh);
  const LatticeState at =
      make_lattice_state(local_minute_of(utc_s), static_cast<std::int16_t>(context), 0, 0);
  return decision_map_json(make_decision_map(at, thresholds, decide_with_student));
}

}  // namespace bess
