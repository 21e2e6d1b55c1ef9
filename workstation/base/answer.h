// Header and common member names of every --json answer. report/page/answers.schema.json
// ('bess-train schema') defines each member, its unit and when it is null; a test checks every
// answer and table against it. A figure is FIGURE_UNIT, its error FIGURE_standard_error in the same
// unit. The options do not change the members of an answer.
#pragma once

#include <algorithm>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/host/json.h"

namespace bess {

// Ordered names and values, such as the contents of a run or the training scope of a model.

using Entries = std::vector<std::pair<std::string, std::string>>;

/// Empty without this name.
inline std::string value_in(const Entries& entries, std::string_view name) {
  const auto found = std::ranges::find(entries, name, &Entries::value_type::first);
  return found == entries.end() ? std::string() : found->second;
}

/// Object of texts.
inline Json json_of(const Entries& entries) {
  Json json = Json::object();
  for (const auto& [name, value] : entries) json.set(name.c_str(), value);
  return json;
}

/// Incremented when a member is removed or changes its meaning, not when one is added.
inline constexpr int kSchemaVersion = 1;

namespace key {
inline constexpr const char* kProfit = "profit_eur_per_day_per_mwh";
inline constexpr const char* kProfitError = "profit_standard_error";
inline constexpr const char* kProfitErrorByMonth = "profit_standard_error_by_month";
inline constexpr const char* kGain = "gain_eur_per_day_per_mwh";
inline constexpr const char* kGainError = "gain_standard_error";
inline constexpr const char* kGainErrorByMonth = "gain_standard_error_by_month";
inline constexpr const char* kGainOver = "gain_over";
inline constexpr const char* kShareOfForesight = "share_of_foresight";
inline constexpr const char* kCarrySoc = "carry_soc";
inline constexpr const char* kCarriedOver = "carried_over";
}  // namespace key

/// {"schema_version": 1, "answer": "KIND"}, the first members of every answer, and `members`.
inline Json answer(const char* kind, std::initializer_list<JsonMember> members = {}) {
  Json json = Json::object({{"schema_version", kSchemaVersion}, {"answer", kind}});
  for (const JsonMember& member : members) json.set(member.key, std::move(member.value));
  return json;
}

/// null for an empty text.
inline Json text_or_null(const std::string& text) { return value_or_null(!text.empty(), text); }

/// "true" or "false", as in JSON, for tables.
constexpr const char* truth(bool value) { return value ? "true" : "false"; }

}  // namespace bess
