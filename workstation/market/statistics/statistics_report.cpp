#include "workstation/market/statistics/statistics_report.h"

#include <fmt/core.h>

#include <cmath>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"
#include "workstation/base/answer.h"

namespace bess {
namespace {

std::string day_of(const ClockChange& change) {
  return fmt::format("{:04}-{:02}-{:02}", change.year, change.month, change.day);
}

std::string format_price_text(std::string_view what, const PriceStatistics& price) {
  std::string text = fmt::format("{}, EUR/MWh, {}\n", what, counted(price.count, "quarter-hour"));
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

std::string format_regimes_text(const std::vector<RegimeStatistics>& regimes) {
  std::string text = fmt::format("{:<52} {:>6} {:>8} {:>25} {:>8} {:>8}\n", "by price regime",
                                 "count", "mean", "quartiles", "< -200", "> 1000");
  for (const auto& [regime, price] : regimes) {
    text += fmt::format("  {:<50} {:>6}", regime->name, price.count);
    text += price.count == 0
                ? "\n"
                : fmt::format(" {:>8.2f} {:>25} {:>6.2f} % {:>6.3f} %\n", price.mean,
                              fmt::format("{:.2f} / {:.2f} / {:.2f}", price.quartile_1,
                                          price.median, price.quartile_3),
                              100 * price.share_below_minus_200, 100 * price.share_above_1000);
  }
  return text;
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
  // Without a price none of its figures is known.
  const auto set = [&](const char* name, double figure) {
    json.set(name, price.count > 0 ? figure : NAN);
  };
  json.set("quarter_hours", price.count);
  set("settled_eur_per_mwh_mean", price.mean);
  set("settled_eur_per_mwh_min", price.minimum);
  set("settled_eur_per_mwh_quartile_1", price.quartile_1);
  set("settled_eur_per_mwh_median", price.median);
  set("settled_eur_per_mwh_quartile_3", price.quartile_3);
  set("settled_eur_per_mwh_max", price.maximum);
  set("share_below_minus_200", price.share_below_minus_200);
  set("share_below_0", price.share_below_0);
  set("share_above_1000", price.share_above_1000);
  set("sign_flip_rate", price.sign_flip_rate);
  Json lags = Json::object();
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    lags.set(std::to_string(kAutocorrelationLags[i]).c_str(),
             price.count > 0 ? price.autocorrelation[i] : NAN);
  }
  json.set("autocorrelation", std::move(lags));
}

Json regimes_json(const std::vector<RegimeStatistics>& regimes) {
  Json list = Json::list();
  for (const auto& [regime, price] : regimes) {
    Json row = Json::object({{"regime", regime->name}});
    add_price(row, price);
    list.add(std::move(row));
  }
  return list;
}

Json convergence_json(const ConvergenceByMinute& convergence) {
  Json list = Json::list();
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    const bool known = convergence[m].count > 0;
    const double median = known ? convergence[m].median_error : NAN;
    const double mean = known ? convergence[m].mean_error : NAN;
    list.add(Json::object({{"minute", m},
                           {"rows", convergence[m].count},
                           {"error_eur_per_mwh_median", median},
                           {"error_eur_per_mwh_mean", mean}}));
  }
  return list;
}

void add_span(Json& json, std::int64_t from_utc_s, std::int64_t until_utc_s) {
  json.set("from_utc", utc_text(from_utc_s).view());
  json.set("until_utc", utc_text(until_utc_s).view());
}

Json gaps_json(const std::vector<Gap>& gaps) {
  Json list = Json::list();
  for (const Gap& gap : gaps) {
    Json span = Json::object();
    add_span(span, gap.from_utc_s, gap.until_utc_s);
    list.add(std::move(span));
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

std::string format_statistics_text(const MarketStatistics& statistics, std::string_view what) {
  std::string text = fmt::format("{} to {}\n", utc_text(statistics.from_utc_s).view(),
                                 utc_text(statistics.until_utc_s).view());
  text += format_price_text(what, statistics.price);
  text += format_regimes_text(statistics.regimes);
  if (statistics.imbalance_sign_flip_rate) {
    text += fmt::format("system imbalance changes sides between {:.1f} % of quarter-hours\n",
                        100 * *statistics.imbalance_sign_flip_rate);
  }
  if (statistics.convergence) text += format_convergence_text(*statistics.convergence);
  text += describe_gaps(what, statistics.settled_gaps);
  if (statistics.convergence) text += describe_gaps("indicative price", statistics.indicative_gaps);
  for (const ClockChange& change : statistics.clock_changes) {
    text += fmt::format("clock change: {} has {} quarter-hours\n", day_of(change),
                        change.quarter_hours);
  }
  return text;
}

std::string format_statistics_json(const MarketStatistics& statistics) {
  Json json = answer("price_statistics");
  add_span(json, statistics.from_utc_s, statistics.until_utc_s);
  add_price(json, statistics.price);
  json.set("regimes", regimes_json(statistics.regimes));
  json.set("imbalance_sign_flip_rate", statistics.imbalance_sign_flip_rate.value_or(NAN));
  json.set("convergence",
           statistics.convergence ? convergence_json(*statistics.convergence) : Json::null());
  json.set("settled_gaps", gaps_json(statistics.settled_gaps));
  json.set("indicative_gaps", gaps_json(statistics.indicative_gaps));
  json.set("clock_changes", clock_changes_json(statistics.clock_changes));
  return json.line();
}

}  // namespace bess
