#include "shared/host/exchanged_days.h"

#include <algorithm>

#include "shared/battery_model.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

namespace {

constexpr std::int64_t start_of(std::int64_t utc_s) {
  return utc_s / kSecondsPerQuarterHour * kSecondsPerQuarterHour;
}

}  // namespace

QuarterPrices::QuarterPrices(std::span<const SettledQuarter> settled) {
  for (const SettledQuarter& quarter : settled) prices_[quarter.start_utc_s].quarter = quarter;
}

void QuarterPrices::note(std::int64_t tick_utc_s, std::int64_t minute_utc_s, double eur_per_mwh) {
  // Also for the quarter-hour of the tick, in case none of its minutes arrives.
  for (const std::int64_t start_utc_s : {start_of(minute_utc_s), start_of(tick_utc_s)}) {
    const auto [at, is_new] = prices_.try_emplace(start_utc_s);
    Price& price = at->second;
    const bool is_settled = !is_new && price.quarter.state != PriceState::kIndicative;
    if (is_settled || minute_utc_s < price.minute_utc_s) continue;
    price = {minute_utc_s, {start_utc_s, eur_per_mwh, PriceState::kIndicative}};
  }
}

std::optional<SettledQuarter> QuarterPrices::find(std::int64_t utc_s) const {
  const auto found = prices_.find(start_of(utc_s));
  return found == prices_.end() ? std::nullopt : std::optional(found->second.quarter);
}

namespace {

/// Energy of one quarter-hour.
struct Flow {
  double charged_wh = 0;
  double discharged_wh = 0;
};

QuarterHourMoney money_of(const Flow& flow, const std::optional<SettledQuarter>& price,
                          const BatteryParameters& terms) {
  QuarterHourMoney money{.quarter_hours = 1};
  if (!price) {
    money.unpriced = 1;
    return money;
  }
  const double charged_mwh = flow.charged_wh / kWattsPerMegawatt;
  const double discharged_mwh = flow.discharged_wh / kWattsPerMegawatt;
  money.published = price->state != PriceState::kIndicative ? 1 : 0;
  money.validated = price->state == PriceState::kValidated ? 1 : 0;
  money.prices_eur_per_mwh = price->eur_per_mwh;
  // Subtraction prevents -0 on a day without exchange.
  money.earned_eur = 0.0 - (charged_mwh - discharged_mwh) * price->eur_per_mwh;
  if (money.published == 0) money.estimated_eur = money.earned_eur;
  money.contract_eur = exchange_cost_eur(terms, charged_mwh, price->eur_per_mwh) +
                       exchange_cost_eur(terms, -discharged_mwh, price->eur_per_mwh) +
                       money.earned_eur;
  return money;
}

}  // namespace

double QuarterHourMoney::mean_price_eur_per_mwh() const {
  const int priced = quarter_hours - unpriced;
  return priced == 0 ? 0 : prices_eur_per_mwh / priced;
}

void QuarterHourMoney::add(const QuarterHourMoney& other) {
  earned_eur += other.earned_eur;
  estimated_eur += other.estimated_eur;
  contract_eur += other.contract_eur;
  prices_eur_per_mwh += other.prices_eur_per_mwh;
  quarter_hours += other.quarter_hours;
  published += other.published;
  validated += other.validated;
  unpriced += other.unpriced;
}

void ExchangedDay::add(const ExchangedDay& other) {
  charged_wh += other.charged_wh;
  discharged_wh += other.discharged_wh;
  unseen_wh += other.unseen_wh;
  money.add(other.money);
}

std::map<std::int32_t, ExchangedDay> exchanged_days(std::span<const ExchangeSample> samples,
                                                    const QuarterPrices& prices,
                                                    const BatteryParameters& terms) {
  std::map<std::int32_t, ExchangedDay> days;
  std::map<std::int64_t, Flow> quarters;  // by number
  for_each_exchange(samples, [&](const Exchange& exchange) {
    if (!exchange.is_seen && exchange.energy_wh == 0) return;
    const auto utc_s = static_cast<std::int64_t>(exchange.from_utc_s);
    ExchangedDay& day = days[local_day_at(utc_s)];
    Flow& quarter = quarters[utc_s / kSecondsPerQuarterHour];
    day.charged_wh += exchange.charged_wh();
    day.discharged_wh += exchange.discharged_wh();
    quarter.charged_wh += exchange.charged_wh();
    quarter.discharged_wh += exchange.discharged_wh();
    if (!exchange.is_seen) day.unseen_wh += std::fabs(exchange.energy_wh);
  });
  for (const auto& [number, flow] : quarters) {
    const std::int64_t start_utc_s = number * kSecondsPerQuarterHour;
    days[local_day_at(start_utc_s)].money.add(money_of(flow, prices.find(start_utc_s), terms));
  }
  return days;
}

}  // namespace bess
