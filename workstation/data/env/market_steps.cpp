#include "workstation/data/env/market_steps.h"

#include <fmt/format.h>

#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/price_level.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr int kObservationDelayMaxMin = 5;
constexpr int kTrainDayLast = 20;  // [SPEC 4]: 1-20 train, 21-25 validation, 26-end test
constexpr int kValidationDayLast = 25;

Split split_of_day(int day_of_month) {
  if (day_of_month <= kTrainDayLast) return Split::kTrain;
  return day_of_month <= kValidationDayLast ? Split::kValidation : Split::kTest;
}

/// As on the edge: rows without a price or with an implausible price are skipped.
bool is_usable(double eur_per_mwh) {
  return std::fabs(eur_per_mwh * kCentiPerEur) <= kPlausiblePriceMaxCentiEurPerMwh;
}

/// Index of the newest usable row for each minute, -1 before the first one.
std::vector<std::int64_t> newest_published(const MinuteSeries& series) {
  std::vector<std::int64_t> newest(series.size());
  std::int64_t last = -1;
  for (std::size_t m = 0; m < series.size(); ++m) {
    if (is_usable(series.indicative[m])) last = static_cast<std::int64_t>(m);
    newest[m] = last;
  }
  return newest;
}

/// Upper limit of plausible prices; larger ones overflow sums of squares, and an infinite mean
/// would become an index out of range.
constexpr double kPaidPriceMaxEurPerMwh = 1e6;

void require_payable(const MinuteSeries& series) {
  for (std::size_t m = 0; m < series.size(); ++m) {
    if (std::fabs(series.settled[m]) <= kPaidPriceMaxEurPerMwh || std::isnan(series.settled[m]))
      continue;
    fail("the settled price of {} is out of range: {:g} EUR/MWh; correct it or leave it empty",
         utc_text(series.utc_s(m)).view(), series.settled[m]);
  }
}

double paid_price(const MinuteSeries& series, std::size_t minute, Settlement settlement) {
  const double first = series.settled[minute];
  return settlement == Settlement::kStep ? first : 0.5 * (first + series.settled[minute + 1]);
}

bool same_date(const MarketDay& day, const LocalMinute& local) {
  return day.day == local.day && day.month == local.month && day.year == local.year;
}

}  // namespace

Split parse_split(std::string_view name) {
  const auto found = std::ranges::find(kSplitNames, name);
  if (found == kSplitNames.end()) {
    fail("unknown split \"{}\": use {}", name, fmt::join(kSplitNames, ", "));
  }
  return static_cast<Split>(found - kSplitNames.begin());
}

std::string_view split_name(Split split) { return kSplitNames[static_cast<std::size_t>(split)]; }

Settlement parse_settlement(std::string_view name) {
  if (name == "minute") return Settlement::kMinute;
  if (name == "step") return Settlement::kStep;
  fail("unknown settlement \"{}\": use minute or step", name);
}

std::string MarketDay::date() const { return fmt::format("{:04}-{:02}-{:02}", year, month, day); }

std::vector<double> MarketSteps::prices_of(const std::vector<MarketDay>& of_days,
                                           double MarketStep::*price) const {
  std::vector<double> prices;
  for_each_step(*this, of_days, [&](const MarketStep& step) { prices.push_back(step.*price); });
  return prices;
}

std::vector<MarketDay> MarketSteps::days_of(Split split) const {
  std::vector<MarketDay> selected;
  for (const MarketDay& day : days) {
    const bool held_out = split == Split::kHeldOut && day.split != Split::kTrain;
    if (split == Split::kAll || held_out || day.split == split) selected.push_back(day);
  }
  return selected;
}

std::vector<MarketDay> MarketSteps::fitted_days() const {
  std::vector<MarketDay> fitted = days;
  std::erase_if(fitted, [](const MarketDay& day) { return day.split == Split::kTest; });
  return fitted;
}

UtcSpan MarketSteps::span_of(const std::vector<MarketDay>& of_days) const {
  return {of(of_days.front()).front().utc_s, of(of_days.back()).back().utc_s + kSecondsPerStep};
}

void require_training_days(std::size_t count) {
  if (count == 0) fail("no training days (local days 1 to 20) in these prices; add some");
}

namespace {

/// Throws with the reason why there is no day with decisions.
[[noreturn]] void fail_without_days(const MinuteSeries& series) {
  if (has_no_price(series.indicative)) {
    fail(
        "the prices have no indicative price to decide on; 'bess-train prices "
        "reconstruct' draws them from quarter-hours");
  }
  if (has_no_price(series.settled)) {
    fail("the prices have no settled price to pay; import settled quarter-hours");
  }
  fail("the prices have no complete local day (at least {} of 720 decisions); add more days",
       kCompleteDaySteps);
}

}  // namespace

MarketSteps make_market_steps(const MinuteSeries& series, const MarketOptions& options) {
  if (options.observation_delay_min < 0 ||
      options.observation_delay_min > kObservationDelayMaxMin) {
    fail("observation delay {} min is out of range: use 0 to {}", options.observation_delay_min,
         kObservationDelayMaxMin);
  }
  require_payable(series);
  const std::vector<std::int64_t> newest = newest_published(series);
  MarketSteps market;
  market.steps.reserve(series.size() / kMinutesPerStep);
  PriceLevel level;
  const std::size_t first = series.start_utc_s / 60 % kMinutesPerStep == 0 ? 0 : 1;
  for (std::size_t m = first; m + 1 < series.size(); m += kMinutesPerStep) {
    const std::int64_t visible = static_cast<std::int64_t>(m) - options.observation_delay_min;
    if (visible < 0) continue;
    const std::int64_t row = newest[static_cast<std::size_t>(visible)];
    if (row < 0) continue;
    const auto newest_row = static_cast<std::size_t>(row);
    level.observe(series.utc_s(newest_row), price_centi_of(series.indicative[newest_row]));
    const double paid = paid_price(series, m, options.settlement);
    if (std::isnan(paid)) continue;
    const std::int64_t utc_s = series.utc_s(m);
    const LocalMinute local = local_minute_of(utc_s);
    if (market.days.empty() || !same_date(market.days.back(), local)) {
      market.days.push_back(
          {local.year, local.month, local.day, split_of_day(local.day), market.steps.size(), 0});
    }
    ++market.days.back().step_count;
    market.steps.push_back(
        {.utc_s = utc_s,
         .observed_eur_per_mwh = series.indicative[newest_row],
         .paid_eur_per_mwh = paid,
         .level_centi_eur_per_mwh = level.centi_eur_per_mwh(),
         .observed_age_min = static_cast<std::int16_t>(static_cast<std::int64_t>(m) - row),
         .minute_of_quarter_hour = static_cast<std::int8_t>(local.minute_of_quarter_hour),
         .quarter_hour = static_cast<std::int8_t>(local.quarter_hour),
         .month = static_cast<std::int8_t>(local.month),
         .half_hour_phase = static_cast<std::int8_t>(local.minute_of_day % 30 / kMinutesPerStep)});
  }
  std::erase_if(market.days, [](const MarketDay& d) { return d.step_count < kCompleteDaySteps; });
  if (market.days.empty()) fail_without_days(series);
  return market;
}

void attach_day_ahead(MarketSteps& market, std::shared_ptr<const DayAheadPublication> day_ahead) {
  market.day_ahead = std::move(day_ahead);
  for (MarketStep& step : market.steps) step.day_ahead = market.day_ahead.get();
}

}  // namespace bess
