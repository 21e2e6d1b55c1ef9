#include "tools/hil_runner/scenario/publication.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/scaled_clock.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr int kMinutesBefore = 4 * 24 * 60;

double made_up_price(const ScenarioPrices& prices, double minute) {
  if (prices.steps.empty()) {
    const double turns = minute / prices.wave_period_min;
    return prices.wave_mean_eur_per_mwh +
           prices.wave_amplitude_eur_per_mwh * std::sin(2 * std::numbers::pi * turns);
  }
  return step_value_at(prices.steps, minute);
}

MinuteSeries made_up_series(const Scenario& scenario) {
  MinuteSeries series;
  series.start_utc_s = scenario.start_utc_s - 60 * kMinutesBefore;
  const int end = static_cast<int>(std::ceil(scenario.minutes)) + 60;
  for (int minute = -kMinutesBefore; minute < end; ++minute) {
    // Rounded to the resolution of the edge.
    const double price = std::round(100 * made_up_price(scenario.prices, minute)) / 100;
    series.indicative.push_back(price);
    series.settled.push_back(price);
  }
  return series;
}

double made_up_day_ahead(std::int64_t utc_s) {
  const LocalMinute local = local_minute_of(utc_s);
  const int hour = local.minute_of_day / 60;
  const std::int64_t day =
      utc_from_civil({local.year, local.month, local.day, 0, 0, 0}) / kSecondsPerDay;
  const double of_hour = hour >= 18 && hour < 21   ? 110
                         : hour >= 11 && hour < 16 ? -70
                         : hour >= 7 && hour < 10  ? 60
                                                   : 0;
  return 80 + of_hour + 9 * static_cast<double>(day % 7) + 2 * (local.quarter_hour % 4);
}

}  // namespace

MinuteSeries scenario_prices(const Scenario& scenario) {
  MinuteSeries series = scenario.prices.file.empty() ? made_up_series(scenario)
                                                     : read_minute_file(scenario.prices.file);
  const std::int64_t last_utc_s = scenario.end_utc_ns() / kNanosecondsPerSecond - 60;
  if (scenario.start_utc_s < series.start_utc_s ||
      last_utc_s >= series.start_utc_s + 60 * static_cast<std::int64_t>(series.size())) {
    fail("{}: {} does not contain the minutes from {} to {}", scenario.path, scenario.prices.file,
         utc_text(scenario.start_utc_s).view(), utc_text(last_utc_s).view());
  }
  const auto first = (scenario.start_utc_s - series.start_utc_s) / 60;
  for (const MinuteSpan& gap : scenario.prices.missing) {
    const auto from = first + static_cast<std::int64_t>(gap.from_min);
    const auto to = std::min<double>(static_cast<double>(first) + gap.to_min,
                                     static_cast<double>(series.size()));
    for (auto m = from; m < static_cast<std::int64_t>(to); ++m) {
      series.indicative[static_cast<std::size_t>(m)] = std::nan("");
    }
  }
  return series;
}

std::string day_ahead_csv(const Scenario& scenario) {
  if (!scenario.day_ahead_file.empty()) return read_file(scenario.day_ahead_file);
  std::string csv = "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc\n";
  const std::int64_t end_utc_s = scenario.end_utc_ns() / kNanosecondsPerSecond + 2 * kSecondsPerDay;
  for (std::int64_t t = local_midnight_utc_s(scenario.start_utc_s, -1); t < end_utc_s;
       t += kSecondsPerQuarterHour) {
    csv += fmt::format("{},{:.2f},15,\n", utc_text(t).view(), made_up_day_ahead(t));
  }
  return csv;
}

std::vector<AuctionRow> day_ahead_rows(const Scenario& scenario) {
  return parse_auction_rows(day_ahead_csv(scenario), scenario.day_ahead_file.empty()
                                                         ? scenario.path
                                                         : scenario.day_ahead_file);
}

Publication::Publication(const Scenario& scenario, const MinuteSeries& prices)
    : scenario_(scenario), prices_(prices) {
  const MarketFaultSchedule& fault = scenario.price_fault;
  constexpr MarketFault kDumb[] = {MarketFault::kHttp500, MarketFault::kGarbage,
                                   MarketFault::kTrailing, MarketFault::kTwice};
  const bool is_dumb = std::ranges::find(kDumb, fault.fault) != std::end(kDumb);
  if (is_dumb && fault.every == 1)
    silent_.push_back({.from_min = fault.from_s / 60, .to_min = fault.to_s / 60});
  double from_min = -1;
  for (const ScenarioEvent& event : scenario.events) {
    using enum ScenarioEvent::EventKind;
    if (event.kind == kMarketPause || event.kind == kMarketKill) from_min = event.at_min;
    if ((event.kind == kMarketContinue || event.kind == kMarketStart) && from_min >= 0) {
      silent_.push_back({.from_min = from_min, .to_min = event.at_min});
      from_min = -1;
    }
  }
  if (from_min >= 0) silent_.push_back({.from_min = from_min});
}

std::optional<Publication::Row> Publication::newest(std::int64_t utc_ns) const {
  for (const MinuteSpan& span : silent_) {
    if (utc_ns < scenario_.utc_ns_at(span.from_min)) continue;
    if (utc_ns < scenario_.utc_ns_at(span.to_min)) {
      return newest_published(scenario_.utc_ns_at(span.from_min), 0);
    }
  }
  const MarketFaultSchedule& fault = scenario_.price_fault;
  const std::int64_t from_ns = scenario_.utc_ns_at(fault.from_s / 60);
  const bool is_struck =
      fault.every == 1 && utc_ns >= from_ns && utc_ns < scenario_.utc_ns_at(fault.to_s / 60);
  if (is_struck && fault.fault == MarketFault::kNull) return newest_published(utc_ns, 1);
  if (is_struck && fault.fault == MarketFault::kStale) {
    // Older answers do not replace newer rows.
    return newest_published(std::max(from_ns, utc_ns - kStaleAnswerS * kNanosecondsPerSecond), 0);
  }
  return newest_published(utc_ns, 0);
}

/// `skip`: number of newest minutes without a price.
std::optional<Publication::Row> Publication::newest_published(std::int64_t utc_ns, int skip) const {
  const auto latency_ns = std::llround(scenario_.prices.latency_s * 1e9);
  const std::int64_t last_utc_s = (utc_ns - latency_ns) / kNanosecondsPerSecond / 60 * 60 - 60;
  std::int64_t minute = (last_utc_s - prices_.start_utc_s) / 60;
  minute = std::min(minute, static_cast<std::int64_t>(prices_.size()) - 1) - skip;
  for (; minute >= 0; --minute) {
    const double price = shown(minute);
    if (!std::isnan(price)) {
      return Row{.minute_utc_s = prices_.start_utc_s + 60 * minute, .eur_per_mwh = price};
    }
  }
  return std::nullopt;
}

double Publication::shown(std::int64_t minute) const {
  const auto price = [this](std::int64_t m) {
    return prices_.indicative[static_cast<std::size_t>(m)];
  };
  const std::int64_t frozen = (scenario_.price_fault_utc_s() - prices_.start_utc_s) / 60;
  const bool is_frozen = scenario_.price_fault.fault == MarketFault::kFrozen && minute >= frozen;
  if (!is_frozen || std::isnan(price(minute))) return price(minute);
  std::int64_t last = frozen - 1;
  while (last > 0 && std::isnan(price(last))) --last;
  return last < 0 ? price(minute) : price(last);
}

std::optional<double> Publication::price_of(std::int64_t minute_utc_s) const {
  const std::int64_t minute = (minute_utc_s - prices_.start_utc_s) / 60;
  if (minute < 0 || minute >= static_cast<std::int64_t>(prices_.size())) return std::nullopt;
  const double price = shown(minute);
  return std::isnan(price) ? std::nullopt : std::optional(price);
}

}  // namespace bess
