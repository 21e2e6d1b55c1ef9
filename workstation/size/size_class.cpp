#include "workstation/size/size_class.h"

#include <algorithm>
#include <cmath>

#include "workstation/base/in_parallel.h"
#include "workstation/base/progress.h"
#include "workstation/chain/policy_factory.h"
#include "workstation/env/charge_left.h"
#include "workstation/market/series/local_date.h"
#include "workstation/planners/baselines.h"

namespace bess {
namespace {

/// All days that are traded, as days of the whole market.
std::vector<MarketDay> traded_days(const MarketSteps& market, const Evaluation& traded) {
  std::vector<MarketDay> days;
  auto next = traded.days.begin();
  for (const MarketDay& day : market.days) {
    if (next == traded.days.end() || next->date != day.date()) continue;
    days.push_back(day);
    ++next;
  }
  return days;
}

/// One plan over the whole series, as walk_forward() has it for each of its months.
double foresight_profit(const MarketSteps& market, const RunConfig& config,
                        const std::vector<MarketDay>& days) {
  const auto policy = make_baseline(kForesightName, market, config.battery);
  Evaluation bound =
      evaluate(market, days, *policy, {config.battery, config.initial_soc_frac, true});
  value_charge_left(bound, config.battery, mean_settled_eur_per_mwh(market, days));
  return bound.profit_eur_per_day_per_mwh();
}

SizeClass trade_class(const RunConfig& config, const SizeTrial& trial) {
  const FoldPolicy make = [&](const Fold& fold) {
    return make_policy(trial.policy, fold.market, config.battery);
  };
  std::vector<StepRecord> steps;
  WalkForward walked = walk_forward(trial.policy, trial.folds, make, config.battery,
                                    config.initial_soc_frac, trial.market, false, &steps);
  const double bound =
      foresight_profit(trial.market, config, traded_days(trial.market, walked.total));
  const double profit = walked.total.profit_eur_per_day_per_mwh();
  return {config.battery, std::move(walked.total), month_peaks(steps, config.battery.power_w_max),
          bound > 0 ? profit / bound : NAN};
}

/// Power taken, summed over the minutes of one quarter-hour after the other.
class PeakMeter {
 public:
  explicit PeakMeter(double power_w_max) : power_w_max_(power_w_max) {}

  void add_minute(std::int64_t utc_s, double power_w) {
    if (utc_s / kSecondsPerQuarterHour != quarter_hour_) {
      close();
      quarter_hour_ = utc_s / kSecondsPerQuarterHour;
    }
    watt_minutes_ += std::max(power_w, 0.0);
  }
  std::vector<MonthPeak> peaks() && {
    close();
    return std::move(peaks_);
  }

 private:
  void close() {
    if (quarter_hour_ == 0) return;
    const std::string month =
        format_local_date(local_date_of(quarter_hour_ * kSecondsPerQuarterHour)).substr(0, 7);
    const double share = watt_minutes_ / kMinutesPerQuarterHour / power_w_max_;
    if (peaks_.empty() || peaks_.back().month != month) peaks_.push_back({month, 0});
    peaks_.back().power_share = std::max(peaks_.back().power_share, share);
    watt_minutes_ = 0;
  }

  double power_w_max_;
  std::int64_t quarter_hour_ = 0;  ///< 0: none yet
  double watt_minutes_ = 0;
  std::vector<MonthPeak> peaks_;
};

}  // namespace

std::vector<MonthPeak> month_peaks(const std::vector<StepRecord>& steps, double power_w_max) {
  PeakMeter meter(power_w_max);
  for (const StepRecord& step : steps) {
    for (int minute = 0; minute < kMinutesPerStep; ++minute) {
      meter.add_minute(step.utc_s + 60 * minute, step.power_w);
    }
  }
  return std::move(meter).peaks();
}

std::vector<SizeClass> trade_classes(const std::vector<RunConfig>& configs,
                                     const SizeTrial& trial) {
  std::vector<SizeClass> classes(configs.size());
  Progress progress("size", "classes", static_cast<double>(configs.size()));
  in_parallel(configs.size(), trial.threads, progress,
              [&](std::size_t c) { classes[c] = trade_class(configs[c], trial); });
  return classes;
}

}  // namespace bess
