#include "edge/notify/energy_totals.h"

#include <algorithm>

#include "shared/units_and_limits.h"

namespace bess {
namespace {

constexpr double kWattSecondsPerKwh = 3.6e6;

bool is_counted_up_to(const LogReader& log, const EnergyTotals& before) {
  CycleRecord record;
  return log.read(before.counted_number, record) && record.utc_s == before.counted_utc_s;
}

}  // namespace

void EnergyTotals::count(const CycleRecord& record) {
  const std::int64_t since_s = record.utc_s - counted_utc_s;
  const std::int64_t seconds = std::clamp<std::int64_t>(since_s, 0, kSecondsPerStep);
  counted_utc_s = record.utc_s;
  if (!record.has_measurement) return;
  const std::int64_t energy_ws = seconds * record.measurement.power_w;
  charged_ws += std::max<std::int64_t>(energy_ws, 0);
  discharged_ws += std::max<std::int64_t>(-energy_ws, 0);
}

void EnergyTotals::count_new(const LogReader& log) {
  CycleRecord record;
  const std::uint64_t newest = log.newest_number();
  if (!log.read(newest, record)) return;
  const bool is_known = has_begun() && is_counted_up_to(log, *this);
  // Another log that ends before what was counted: it cannot be told what of it was.
  if (!has_begun() || (!is_known && record.utc_s < counted_utc_s)) {
    counted_number = newest;
    counted_utc_s = record.utc_s;
    return;
  }
  std::uint64_t number = is_known ? counted_number + 1 : log.oldest_number();
  const std::int64_t before_utc_s = counted_utc_s;
  for (; number <= newest; ++number) {
    if (!log.read(number, record) || record.mode == Mode::kStopping) continue;  // no cycle
    if (!is_known && record.utc_s <= before_utc_s) continue;
    count(record);
    counted_number = number;
  }
}

double EnergyTotals::charged_kwh() const {
  return static_cast<double>(charged_ws) / kWattSecondsPerKwh;
}
double EnergyTotals::discharged_kwh() const {
  return static_cast<double>(discharged_ws) / kWattSecondsPerKwh;
}

}  // namespace bess
