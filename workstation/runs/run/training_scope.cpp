#include "workstation/runs/run/training_scope.h"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>

#include "shared/training_period.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/correction/student/student_file.h"
#include "workstation/data/market/series/imbalance_price.h"
#include "workstation/policy/rl/teacher.h"

namespace bess {
namespace {

constexpr const char* kPricesKey = "prices";  // as in run.json

/// Adds keys that `there` lacks, with their default: older files did not have them.
Entries with_defaults(Entries there, const Entries& here) {
  const Entries defaults = circumstances_of(config_entries(RunConfig{}));
  for (const auto& entry : here) {
    const bool known =
        std::ranges::find(there, entry.first, &Entries::value_type::first) != there.end();
    if (!known && std::ranges::find(defaults, entry) != defaults.end()) there.push_back(entry);
  }
  return there;
}

/// Price regimes of `days` without training days, in a sentence; empty when none, or unknown.
std::string unknown_regimes(const Entries& there, const MarketSteps& market,
                            const std::vector<MarketDay>& days) {
  const auto learnt = learnt_span(there);
  if (!learnt || days.empty()) return {};
  const std::string regimes = regimes_not_learnt(*learnt, market.span_of(days));
  if (regimes.empty()) return {};
  return fmt::format(
      "trained on prices of {} to {}, but these days are in another price regime: {}",
      local_date_text(learnt->from_s).view(), local_date_text(learnt->until_s - 1).view(), regimes);
}

}  // namespace

Entries learnt_for(const RunConfig& config, const std::string& prices) {
  Entries entries = circumstances_of(config_entries(config));
  entries.emplace_back(kPricesKey, prices);
  return entries;
}

Entries learnt_for_of(const std::filesystem::path& model) {
  if (!std::filesystem::is_regular_file(model)) return {};
  Entries own =
      is_teacher_file(model) ? load_teacher(model).learnt_for : load_student(model).learnt_for;
  if (!own.empty()) return own;
  const auto run = load_run_record({model.parent_path()});
  if (!run) return {};
  Entries of_run = circumstances_of(run->identity);
  of_run.emplace_back(kPricesKey, run->value(kPricesKey));
  return of_run;
}

std::string learnt_otherwise(const Entries& there, const Entries& here) {
  if (there.empty()) return {};
  Entries of_both = there;
  std::erase_if(of_both, [&](const auto& entry) {
    return std::ranges::find(here, entry.first, &Entries::value_type::first) == here.end();
  });
  return differences(with_defaults(std::move(of_both), here), here);
}

std::string old_prices(const MinuteSeries& series, std::int64_t now_utc_s) {
  const auto date = [](std::int64_t utc_s) { return local_date_text(utc_s); };
  const auto newest = date(series.utc_s(series.size()) - 1);
  const auto age = training_age_text({newest.view(), newest.view()}, date(now_utc_s).view());
  if (age.empty()) return {};
  return fmt::format(
      "the newest day of these prices, {}, was {}; for newer prices: bess-train prices fetch "
      "--from {} --to {} --out FILE, then run --prices FILE",
      newest.view(), age.view(), date(now_utc_s - 365 * kSecondsPerDay).view(),
      date(now_utc_s - kSecondsPerDay).view());
}

void warn_learnt_otherwise(const std::filesystem::path& model, const Entries& here,
                           const MarketSteps& market, const std::vector<MarketDay>& days) {
  const Entries there = learnt_for_of(model);
  std::string other = learnt_otherwise(there, here);
  const std::string regimes = unknown_regimes(there, market, days);
  if (!regimes.empty()) other += (other.empty() ? "" : "; ") + regimes;
  if (other.empty()) return;
  fmt::print(stderr, "bess-train: warning: {} was trained for other conditions: {}\n",
             model.string(), other);
}

void warn_unknown_regimes(const std::string& what, const MarketSteps& fitting,
                          const MarketSteps& market, const std::vector<MarketDay>& days) {
  const std::vector<MarketDay> fitted = fitting.fitted_days();
  if (fitted.empty() || days.empty()) return;
  const std::string regimes = regimes_not_learnt(fitting.span_of(fitted), market.span_of(days));
  if (regimes.empty()) return;
  fmt::print(stderr,
             "bess-train: warning: {}: trained on {} to {}, but traded in a price regime without "
             "training days: {}\n",
             what, fitted.front().date(), fitted.back().date(), regimes);
}

}  // namespace bess
