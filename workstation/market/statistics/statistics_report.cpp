#include "workstation/market/statistics/statistics_report.h"

#include <fmt/core.h>

#include <cmath>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::string day_of(const ClockChange& change) {
  return fmt::format("{:04}-{:02}-{:02}", change.year, change.month, change.day);
}

std::string format_price_text(const PriceStatistics& price) {
  std::string text =
      fmt::format("settled price, EUR/MWh, {}\n", counted(price.count, "quarter-hour"));
  if (price.count == 0) return text;
  text += fmt::format(
      "  mean {:.2f}  minimum {:.2f}  quartiles {:.2f} / {:.2f} / {:.2f}  maximum {:.2f}\n",
      price.mean, price.minimum, price.quartile_1, price.median, price.quartile_3, price.maximum);
  text += fmt::format("  below -200: {:.2f} %  below 0: {:.2f} %  above 1000: {:.3f} %\n",
                      100 * price.share_below_minus_200, 100 * price.share_below_0,
                      100 * price.share_above_1000);
  text += "  autocorrelation";
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    const double value = price.autocorrelation[i];
    text += fmt::format("  lag {}: {}", kAutocorrelationLags[i],
                        std::isfinite(value) ? fmt::format("{:.2f}", value) : "-");
  }
  return text + fmt::format("\n  changes sign between {:.1f} % of quarter-hours\n",
                            100 * price.sign_flip_rate);
}

std::string format_convergence_text(const ConvergenceByMinute& convergence) {
  std::string text = "indicative against settled price, absolute error, EUR/MWh\n";
  text += "  minute    rows    median      mean\n";
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    const Convergence& of_minute = convergence[m];
    if (of_minute.count == 0) continue;
    text += fmt::format("  {:6} {:7} {:9.2f} {:9.2f}\n", m, of_minute.count, of_minute.median_error,
                        of_minute.mean_error);
  }
  return text;
}

void add_price(Json& json, const PriceStatistics& price) {
  json.set("quarter_hours", price.count);
  if (price.count == 0) return;
  json.set("mean", price.mean);
  json.set("minimum", price.minimum);
  json.set("quartile_1", price.quartile_1);
  json.set("median", price.median);
  json.set("quartile_3", price.quartile_3);
  json.set("maximum", price.maximum);
  json.set("share_below_minus_200", price.share_below_minus_200);
  json.set("share_below_0", price.share_below_0);
  json.set("share_above_1000", price.share_above_1000);
  json.set("sign_flip_rate", price.sign_flip_rate);
  Json lags = Json::object();
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    lags.set(std::to_string(kAutocorrelationLags[i]).c_str(), price.autocorrelation[i]);
  }
  json.set("autocorrelation", std::move(lags));
}

Json convergence_json(const ConvergenceByMinute& convergence) {
  Json list = Json::list();
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    const bool known = convergence[m].count > 0;
    list.add(Json::object({{"minute", m},
                           {"rows", convergence[m].count},
                           {"median_error", known ? convergence[m].median_error : NAN},
                           {"mean_error", known ? convergence[m].mean_error : NAN}}));
  }
  return list;
}

Json gaps_json(const std::vector<Gap>& gaps) {
  Json list = Json::list();
  for (const Gap& gap : gaps) {
    list.add(Json::object(
        {{"from", utc_text(gap.from_utc_s).view()}, {"until", utc_text(gap.until_utc_s).view()}}));
  }
  return list;
}

Json clock_changes_json(const std::vector<ClockChange>& changes) {
  Json list = Json::list();
  for (const ClockChange& change : changes) {
    list.add(Json::object({{"day", day_of(change)}, {"quarter_hours", change.quarter_hours}}));
  }
  return list;
}

}  // namespace

std::string format_statistics_text(const MarketStatistics& statistics) {
  std::string text = fmt::format("{} to {}\n", utc_text(statistics.from_utc_s).view(),
                                 utc_text(statistics.until_utc_s).view());
  text += format_price_text(statistics.price);
  if (statistics.imbalance_sign_flip_rate) {
    text += fmt::format("system imbalance changes sides between {:.1f} % of quarter-hours\n",
                        100 * *statistics.imbalance_sign_flip_rate);
  }
  if (statistics.convergence) text += format_convergence_text(*statistics.convergence);
  text += describe_gaps("settled price", statistics.settled_gaps);
  if (statistics.convergence) text += describe_gaps("indicative price", statistics.indicative_gaps);
  for (const ClockChange& change : statistics.clock_changes) {
    text += fmt::format("clock change: {} has {} quarter-hours\n", day_of(change),
                        change.quarter_hours);
  }
  return text;
}

std::string format_statistics_json(const MarketStatistics& statistics) {
  Json json = Json::object({{"from", utc_text(statistics.from_utc_s).view()},
                            {"until", utc_text(statistics.until_utc_s).view()}});
  add_price(json, statistics.price);
  json.set("imbalance_sign_flip_rate", statistics.imbalance_sign_flip_rate.value_or(NAN));
  if (statistics.convergence) json.set("convergence", convergence_json(*statistics.convergence));
  json.set("settled_gaps", gaps_json(statistics.settled_gaps));
  json.set("indicative_gaps", gaps_json(statistics.indicative_gaps));
  json.set("clock_changes", clock_changes_json(statistics.clock_changes));
  return json.line();
}

}  // namespace bess
