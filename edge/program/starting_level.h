// The price level that a controller starts with: kept by the log, or for a student by level filled
// from what the price server still has.
#pragma once

#include <optional>

#include "edge/control/policy.h"
#include "edge/control/price_history.h"
#include "edge/prices/history_pages.h"
#include "edge/program/level_note.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// `logged` is the newest record's, `greeting` what the server has just answered with; `history` is
/// where the rows are kept, so that no stack needs to.
template <typename Prices, typename Clock>
LevelNews starting_level(const EdgeConfig& config, const PriceLevel& logged, Status greeting,
                         Prices& prices, Clock& clock, std::optional<PriceHistory>& history) {
  const std::int64_t now_utc_s = clock.now_utc_ns() / kNanosecondsPerSecond;
  LevelNews news{.hours_wanted = config.price.history.hours, .status = greeting};
  const auto fetch = [&]() -> PriceLevel {
    // A server that has just not answered would only hold up the start.
    const bool has_answered = greeting == Status::kOk || greeting == Status::kNoRow;
    if (news.hours_wanted == 0 || !has_answered) return {};
    history.emplace(news.hours_wanted, now_utc_s);
    news.status = fetch_history(prices, config.price.feed, config.price.history, clock, *history);
    news.hours = history->hours_covered();
    news.rows = history->rows();
    return history->level();
  };
  news.start = find_start_level(student_context().kind, logged, now_utc_s,
                                config.price.level_start_centi_eur_per_mwh, fetch);
  return news;
}

}  // namespace bess
