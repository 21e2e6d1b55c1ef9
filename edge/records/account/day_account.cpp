#include "edge/records/account/day_account.h"

#include <algorithm>
#include <limits>

#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {

void DayAccount::add(const CycleRecord& record) {
  if (record.mode == Mode::kStopping) return;  // no control cycle
  const auto reason = static_cast<std::size_t>(record.reason);
  const bool is_driven = record.mode == Mode::kRunning && record.written;
  ++cycles_;
  ++cycles_by_reason_[reason];
  if (is_driven) ++driven_cycles_;
  if (!is_driven) ++not_driven_[reason];
  if (record.throughput.local_day == local_day_) {
    soc_moved_e4_ = std::max(soc_moved_e4_, record.throughput.soc_moved_e4);
  }
  if (!record.has_measurement) return;
  const Charge now{record.utc_s, record.measurement.soc_e4};
  if (now.utc_s < first_.utc_s) first_ = now;
  if (now.utc_s >= last_.utc_s) {
    last_ = now;
    capacity_wh_ = record.measurement.capacity_wh;
  }
  if (record.price.has_row) ++valued_cycles_;
}

void DayAccount::add(const DayAccount& other) {
  exchanged_.add(other.exchanged_);
  soc_moved_e4_ += other.soc_moved_e4_;
  cycles_ += other.cycles_;
  missing_cycles_ += other.missing_cycles_;
  driven_cycles_ += other.driven_cycles_;
  valued_cycles_ += other.valued_cycles_;
  if (other.first_.utc_s < first_.utc_s) first_ = other.first_;
  if (other.last_.utc_s > last_.utc_s) {
    last_ = other.last_;
    capacity_wh_ = other.capacity_wh_;
  }
  for (std::size_t i = 0; i < cycles_by_reason_.size(); ++i) {
    cycles_by_reason_[i] += other.cycles_by_reason_[i];
    not_driven_[i] += other.not_driven_[i];
  }
}

double DayAccount::full_cycles() const { return soc_moved_e4_ / (2.0 * kSocFullE4); }

double DayAccount::driven_share() const {
  const int all = cycles_ + missing_cycles_;
  return all == 0 ? 0 : static_cast<double>(driven_cycles_) / all;
}

double DayAccount::first_soc_percent() const {
  return has_soc() ? first_.soc_e4 / 100.0 : std::numeric_limits<double>::quiet_NaN();
}

double DayAccount::last_soc_percent() const {
  return has_soc() ? last_.soc_e4 / 100.0 : std::numeric_limits<double>::quiet_NaN();
}

double DayAccount::stored_kwh() const {
  if (!has_soc()) return 0;
  return static_cast<double>(last_.soc_e4 - first_.soc_e4) / kSocFullE4 * capacity_wh_ / 1'000;
}

double DayAccount::stored_eur() const {
  const BatteryParameters battery;
  const double grid_mwh =
      stored_kwh() / 1'000 *
      (stored_kwh() > 0 ? battery.discharge_efficiency : 1 / battery.charge_efficiency);
  return grid_mwh * money().mean_price_eur_per_mwh();
}

int DayAccount::interventions() const {
  return cycles_ - cycles_by_reason_[static_cast<std::size_t>(Reason::kStudent)];
}

std::int64_t DayAccount::start_utc_s() const {
  return utc_from_local({local_day_ / 10'000, local_day_ / 100 % 100, local_day_ % 100, 0, 0, 0});
}

std::string DayAccount::date() const {
  return formatted("%04d-%02d-%02d", local_day_ / 10'000 % 10'000, local_day_ / 100 % 100,
                   local_day_ % 100);
}

std::string DayAccount::interventions_text() const {
  std::string text;
  for (std::size_t i = 0; i < cycles_by_reason_.size(); ++i) {
    const auto reason = static_cast<Reason>(i);
    if (cycles_by_reason_[i] == 0 || reason == Reason::kStudent) continue;
    add_formatted(text, "%s%s %d", text.empty() ? "" : ", ", reason_name(reason).data(),
                  cycles_by_reason_[i]);
  }
  return text;
}

std::string DayAccount::line() const {
  std::string line = formatted(
      "%s: %+.2f EUR (%d of %d quarter-hours at the settled price, an estimate in the others), "
      "charged %.1f kWh, discharged %.1f kWh, %.2f full cycles, %d interventions",
      date().c_str(), earned_eur(), money().published, money().quarter_hours, charged_kwh(),
      discharged_kwh(), full_cycles(), interventions());
  if (interventions() > 0) line += " (" + interventions_text() + ")";
  return line;
}

}  // namespace bess
