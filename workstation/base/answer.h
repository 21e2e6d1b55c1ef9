// How every answer of --json begins, and the names that more than one of them has. What each name
// means, its unit and where it is null stands in report/page/answers.schema.json ('bess-train
// schema'); a test holds every answer and every table against it. A figure is FIGURE_UNIT, its
// error FIGURE_standard_error in the same unit. An answer has the same keys whatever the options.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "shared/host/json.h"

namespace bess {

// Names and values in order: what a run is made of, what a model was learnt for.

using Entries = std::vector<std::pair<std::string, std::string>>;

/// Grows when a name goes or changes its meaning; a new name alone leaves it.
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

/// {"schema_version": 1, "answer": "KIND"}: the first of every answer.
Json answer(const char* kind);

/// null where there is nothing to say.
Json text_or_null(const std::string& text);

/// "true" or "false", as in JSON, for tables.
constexpr const char* truth(bool value) { return value ? "true" : "false"; }

}  // namespace bess
