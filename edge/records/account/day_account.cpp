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
  ++cycles;
  ++cycles_by_reason[reason];
  if (is_driven) ++driven_cycles;
  if (!is_driven) ++not_driven_by_reason[reason];
  if (record.throughput.local_day == local_day) {
    soc_moved_e4 = std::max(soc_moved_e4, record.throughput.soc_moved_e4);
  }
  if (!record.has_measurement) return;
  const Charge now{record.utc_s, record.measurement.soc_e4};
  if (now.utc_s < first.utc_s) first = now;
  if (now.utc_s >= last.utc_s) {
    last = now;
    capacity_wh = record.measurement.capacity_wh;
  }
  if (record.price.has_row) ++valued_cycles;
}

void DayAccount::add(const DayAccount& other) {
  exchanged.add(other.exchanged);
  soc_moved_e4 += other.soc_moved_e4;
  cycles += other.cycles;
  missing_cycles += other.missing_cycles;
  driven_cycles += other.driven_cycles;
  valued_cycles += other.valued_cycles;
  if (other.first.utc_s < first.utc_s) first = other.first;
  if (other.last.utc_s > last.utc_s) {
    last = other.last;
    capacity_wh = other.capacity_wh;
  }
  for (std::size_t i = 0; i < cycles_by_reason.size(); ++i) {
    cycles_by_reason[i] += other.cycles_by_reason[i];
    not_driven_by_reason[i] += other.not_driven_by_reason[i];
  }
}

double DayAccount::full_cycles() const { return soc_moved_e4 / (2.0 * kSocFullE4); }

double DayAccount::driven_share() const {
  const int all = cycles + missing_cycles;
  return all == 0 ? 0 : static_cast<double>(driven_cycles) / all;
}

double DayAccount::first_soc_percent() const {
  return has_soc() ? first.soc_e4 / 100.0 : std::numeric_limits<double>::quiet_NaN();
}

double DayAccount::last_soc_percent() const {
  return has_soc() ? last.soc_e4 / 100.0 : std::numeric_limits<double>::quiet_NaN();
}

double DayAccount::stored_kwh() const {
  if (!has_soc()) return 0;
  return static_cast<double>(last.soc_e4 - first.soc_e4) / kSocFullE4 * capacity_wh / 1'000;
}

double DayAccount::stored_eur() const {
  const BatteryParameters battery;
  const double grid_mwh =
      stored_kwh() / 1'000 *
      (stored_kwh() > 0 ? battery.discharge_efficiency : 1 / battery.charge_efficiency);
  return grid_mwh * exchanged.money.mean_price_eur_per_mwh();
}

int DayAccount::interventions() const {
  return cycles - cycles_by_reason[static_cast<std::size_t>(Reason::kStudent)];
}

std::int64_t local_day_start_utc_s(std::int32_t local_day) {
  return utc_from_local({local_day / 10'000, local_day / 100 % 100, local_day % 100, 0, 0, 0});
}

std::string local_day_text(std::int32_t local_day) {
  return formatted("%04d-%02d-%02d", local_day / 10'000 % 10'000, local_day / 100 % 100,
                   local_day % 100);
}

std::string DayAccount::interventions_text() const {
  std::string text;
  for (std::size_t i = 0; i < cycles_by_reason.size(); ++i) {
    const auto reason = static_cast<Reason>(i);
    if (cycles_by_reason[i] == 0 || reason == Reason::kStudent) continue;
    add_formatted(text, "%s%s %d", text.empty() ? "" : ", ", reason_name(reason).data(),
                  cycles_by_reason[i]);
  }
  return text;
}

std::string DayAccount::line() const {
  std::string line = formatted(
      "%s: %+.2f EUR (%d of %d quarter-hours at the settled price, an estimate in the others), "
      "charged %.1f kWh, discharged %.1f kWh, %.2f full cycles, %d interventions",
      local_day_text(local_day).c_str(), exchanged.money.earned_eur, exchanged.money.published,
      exchanged.money.quarter_hours, charged_kwh(), discharged_kwh(), full_cycles(),
      interventions());
  if (interventions() > 0) line += " (" + interventions_text() + ")";
  return line;
}

}  // namespace bess
