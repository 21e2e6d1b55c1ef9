// The price level that a controller starts with: kept by the log, or for a student by level filled
// from the prices of the last hours.
#pragma once

#include "edge/control/policy.h"
#include "edge/prices/published_prices.h"
#include "edge/program/start_notes.h"
#include "edge/settings/edge_config.h"

namespace bess {

/// `logged` is the newest record's, `greeting` what prices have just answered with.
template <typename World>
LevelNews starting_level(const EdgeConfig& config, const PriceLevel& logged, Status greeting,
                         World& world) {
  const std::int64_t now_utc_s = world.clock().now_utc_ns() / kNanosecondsPerSecond;
  LevelNews news{.hours_wanted = config.price.history.hours, .status = greeting};
  const auto fetch = [&]() -> PriceLevel {
    // A server that has just not answered would only hold up the start.
    const bool has_answered = greeting == Status::kOk || greeting == Status::kNoRow;
    if (news.hours_wanted == 0 || !has_answered) return {};
    const PublishedHistory history = world.find_history();
    news.status = history.status;
    news.hours = history.hours;
    news.rows = history.rows;
    return history.level;
  };
  news.start = find_start_level(student_context().kind, logged, now_utc_s,
                                config.price.level_start_centi_eur_per_mwh, fetch);
  return news;
}

}  // namespace bess
