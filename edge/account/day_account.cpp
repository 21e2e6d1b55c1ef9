#include "edge/account/day_account.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

void QuarterHourMoney::add(const QuarterHourMoney& other) {
  earned_eur += other.earned_eur;
  estimated_eur += other.estimated_eur;
  prices_eur_per_mwh += other.prices_eur_per_mwh;
  contract_eur += other.contract_eur;
  quarter_hours += other.quarter_hours;
  published += other.published;
  validated += other.validated;
  unpriced += other.unpriced;
}

double QuarterHourMoney::mean_price_eur_per_mwh() const {
  const int priced = quarter_hours - unpriced;
  return priced == 0 ? 0 : prices_eur_per_mwh / priced;
}

void DayAccount::add(const CycleRecord& record) {
  if (record.mode == Mode::kStopping) return;  // no cycle
  ++cycles_;
  ++cycles_by_reason_[static_cast<std::size_t>(record.reason)];
  if (record.mode == Mode::kRunning) ++driven_cycles_;
  if (record.throughput.local_day == local_day_) {
    soc_moved_e4_ = std::max(soc_moved_e4_, record.throughput.soc_moved_e4);
  }
  if (!record.has_measurement) return;
  note_soc(record);
  if (record.price.has_row) ++valued_cycles_;
}

void DayAccount::add(const Exchange& exchange) {
  const double size_wh = std::fabs(exchange.energy_wh);
  (exchange.energy_wh > 0 ? charged_wh_ : discharged_wh_) += size_wh;
  if (!exchange.is_seen) unseen_wh_ += size_wh;
}

void DayAccount::note_soc(const CycleRecord& record) {
  if (record.utc_s < first_soc_utc_s_) {
    first_soc_utc_s_ = record.utc_s;
    first_soc_e4_ = record.measurement.soc_e4;
  }
  if (record.utc_s >= last_soc_utc_s_) {
    last_soc_utc_s_ = record.utc_s;
    last_soc_e4_ = record.measurement.soc_e4;
    capacity_wh_ = record.measurement.capacity_wh;
  }
}

double DayAccount::full_cycles() const { return soc_moved_e4_ / (2.0 * kSocFullE4); }

int DayAccount::interventions() const {
  return cycles_ - cycles_by_reason_[static_cast<std::size_t>(Reason::kStudent)];
}

std::int64_t DayAccount::start_utc_s() const {
  return utc_from_local({.year = local_day_ / 10'000,
                         .month = local_day_ / 100 % 100,
                         .day = local_day_ % 100,
                         .hour = 0,
                         .minute = 0,
                         .second = 0});
}

std::string DayAccount::date() const {
  char text[16];
  std::snprintf(text, sizeof text, "%04d-%02d-%02d", local_day_ / 10'000 % 10'000,
                local_day_ / 100 % 100, local_day_ % 100);
  return text;
}

std::string interventions_text(const CyclesByReason& cycles) {
  std::string text;
  for (int i = 0; i < kReasonCount; ++i) {
    const int count = cycles[static_cast<std::size_t>(i)];
    if (count == 0 || static_cast<Reason>(i) == Reason::kStudent) continue;
    text.append(text.empty() ? "" : ", ").append(reason_name(static_cast<Reason>(i)));
    text.append(" ").append(std::to_string(count));
  }
  return text;
}

std::string DayAccount::line() const {
  char text[512];
  char fees[64] = "no fees";
  if (money_.contract_eur != 0) {
    std::snprintf(fees, sizeof fees, "%.2f EUR of fees not taken off", money_.contract_eur);
  }
  std::snprintf(
      text, sizeof text,
      "%s: %+.2f EUR (%d of %d quarter-hours at the settled price, an estimate in the others; %s), "
      "charged %.1f kWh, discharged %.1f kWh, %.2f full cycles, %d interventions",
      date().c_str(), earned_eur(), money_.published, money_.quarter_hours, fees, charged_kwh(),
      discharged_kwh(), full_cycles(), interventions());
  std::string line = text;
  if (interventions() > 0) line += " (" + interventions_text(cycles_by_reason_) + ")";
  return line;
}

}  // namespace bess
