#include "workstation/sweep/own_rate.h"

#include <algorithm>
#include <cmath>

#include "workstation/chain/policy_factory.h"
#include "workstation/env/charge_left.h"
#include "workstation/env/evaluate.h"
#include "workstation/market/series/judged_prices.h"
#include "workstation/run/run_folder.h"
#include "workstation/sweep/sweep_plan.h"

namespace bess {

std::optional<OwnRates::Earned> OwnRates::earned(const CollectedTask& task, const Site& site) {
  const double rate_per_h = site.power_w / site.capacity_wh;
  const auto [at, is_new] = known_.try_emplace({task.task.number, rate_per_h});
  if (is_new) at->second = evaluated(task, rate_per_h);
  return at->second;
}

std::optional<OwnRates::Earned> OwnRates::evaluated(const CollectedTask& task, double rate_per_h) {
  if (!base_) base_ = load_run_config(folder_.base());
  RunConfig config = config_of_task(folder_, *base_, task.task);
  const double power_w = rate_per_h * config.battery.capacity_wh;
  const double ratio = power_w / config.battery.power_w_max;
  if (std::abs(ratio - 1) < 1e-9) return std::nullopt;  // the canonical one has twelve digits
  config.battery.power_w_max = power_w;
  const std::string prices = folder_.prices().string();
  if (!prices_) prices_ = read_judged_minutes(prices, AcceptedFindings::all());
  const MarketSteps market = market_of(*prices_, config.market, prices);
  const auto days = market.days_of(Split::kTest);
  const auto student = folder_.result(task.task.number) / run_file::kStudent;
  const auto policy = make_policy(student.string(), market, config.battery);
  Evaluation carried =
      evaluate(market, days, *policy, {config.battery, config.initial_soc_frac, true}, nullptr);
  value_charge_left(carried, config.battery, mean_settled_eur_per_mwh(market, days));
  const double profit = carried.profit_eur_per_day_per_mwh();
  return Earned{profit, std::max(1.0, ratio) * task.figures->profit - profit};
}

}  // namespace bess
