#include "workstation/market/statistics/statistics_report.h"

#include <cjson/cJSON.h>
#include <fmt/core.h>

#include <cmath>
#include <memory>

#include "shared/host/text.h"

namespace bess {
namespace {

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

struct Delete {
  void operator()(cJSON* json) const { cJSON_Delete(json); }
};

/// JSON has no NaN: an unknown figure is null.
void add_number(cJSON* object, const char* key, double value) {
  if (std::isfinite(value)) {
    cJSON_AddNumberToObject(object, key, value);
  } else {
    cJSON_AddNullToObject(object, key);
  }
}

void add_price_json(cJSON* root, const PriceStatistics& price) {
  add_number(root, "quarter_hours", static_cast<double>(price.count));
  if (price.count == 0) return;
  add_number(root, "mean", price.mean);
  add_number(root, "minimum", price.minimum);
  add_number(root, "quartile_1", price.quartile_1);
  add_number(root, "median", price.median);
  add_number(root, "quartile_3", price.quartile_3);
  add_number(root, "maximum", price.maximum);
  add_number(root, "share_below_minus_200", price.share_below_minus_200);
  add_number(root, "share_below_0", price.share_below_0);
  add_number(root, "share_above_1000", price.share_above_1000);
  add_number(root, "sign_flip_rate", price.sign_flip_rate);
  cJSON* lags = cJSON_AddObjectToObject(root, "autocorrelation");
  for (std::size_t i = 0; i < kAutocorrelationLags.size(); ++i) {
    add_number(lags, std::to_string(kAutocorrelationLags[i]).c_str(), price.autocorrelation[i]);
  }
}

void add_convergence_json(cJSON* root, const ConvergenceByMinute& convergence) {
  cJSON* list = cJSON_AddArrayToObject(root, "convergence");
  for (std::size_t m = 0; m < convergence.size(); ++m) {
    cJSON* of_minute = cJSON_CreateObject();
    cJSON_AddItemToArray(list, of_minute);
    const bool known = convergence[m].count > 0;
    add_number(of_minute, "minute", static_cast<double>(m));
    add_number(of_minute, "rows", static_cast<double>(convergence[m].count));
    add_number(of_minute, "median_error", known ? convergence[m].median_error : NAN);
    add_number(of_minute, "mean_error", known ? convergence[m].mean_error : NAN);
  }
}

void add_gaps_json(cJSON* root, const char* key, const std::vector<Gap>& gaps) {
  cJSON* list = cJSON_AddArrayToObject(root, key);
  for (const Gap& gap : gaps) {
    cJSON* item = cJSON_CreateObject();
    cJSON_AddItemToArray(list, item);
    cJSON_AddStringToObject(item, "from", format_utc(gap.from_utc_s).c_str());
    cJSON_AddStringToObject(item, "until", format_utc(gap.until_utc_s).c_str());
  }
}

void add_clock_changes_json(cJSON* root, const std::vector<ClockChange>& changes) {
  cJSON* list = cJSON_AddArrayToObject(root, "clock_changes");
  for (const ClockChange& change : changes) {
    cJSON* item = cJSON_CreateObject();
    cJSON_AddItemToArray(list, item);
    const std::string day = fmt::format("{:04}-{:02}-{:02}", change.year, change.month, change.day);
    cJSON_AddStringToObject(item, "day", day.c_str());
    cJSON_AddNumberToObject(item, "quarter_hours", change.quarter_hours);
  }
}

}  // namespace

std::string format_statistics_text(const MarketStatistics& statistics) {
  std::string text = fmt::format("{} to {}\n", format_utc(statistics.from_utc_s),
                                 format_utc(statistics.until_utc_s));
  text += format_price_text(statistics.price);
  if (statistics.imbalance_sign_flip_rate) {
    text += fmt::format("system imbalance changes sides between {:.1f} % of quarter-hours\n",
                        100 * *statistics.imbalance_sign_flip_rate);
  }
  if (statistics.convergence) text += format_convergence_text(*statistics.convergence);
  text += describe_gaps("settled price", statistics.settled_gaps);
  if (statistics.convergence) text += describe_gaps("indicative price", statistics.indicative_gaps);
  for (const ClockChange& change : statistics.clock_changes) {
    text += fmt::format("clock change: {:04}-{:02}-{:02} has {} quarter-hours\n", change.year,
                        change.month, change.day, change.quarter_hours);
  }
  return text;
}

std::string format_statistics_json(const MarketStatistics& statistics) {
  const std::unique_ptr<cJSON, Delete> root(cJSON_CreateObject());
  cJSON_AddStringToObject(root.get(), "from", format_utc(statistics.from_utc_s).c_str());
  cJSON_AddStringToObject(root.get(), "until", format_utc(statistics.until_utc_s).c_str());
  add_price_json(root.get(), statistics.price);
  add_number(root.get(), "imbalance_sign_flip_rate",
             statistics.imbalance_sign_flip_rate.value_or(NAN));
  if (statistics.convergence) add_convergence_json(root.get(), *statistics.convergence);
  add_gaps_json(root.get(), "settled_gaps", statistics.settled_gaps);
  add_gaps_json(root.get(), "indicative_gaps", statistics.indicative_gaps);
  add_clock_changes_json(root.get(), statistics.clock_changes);
  char* printed = cJSON_PrintUnformatted(root.get());
  std::string text = printed;
  cJSON_free(printed);
  return text;
}

}  // namespace bess
