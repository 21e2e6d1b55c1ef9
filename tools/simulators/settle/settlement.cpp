#include "tools/simulators/settle/settlement.h"

#include <algorithm>
#include <cmath>

#include "shared/battery_model.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// Throws UserError when the minute has no settled price.
double settled_at(const MinuteSeries& prices, std::int64_t minute_utc_s) {
  const std::int64_t minute = (minute_utc_s - prices.start_utc_s) / 60;
  const bool is_inside =
      minute_utc_s >= prices.start_utc_s && minute < static_cast<std::int64_t>(prices.size());
  const double price = is_inside ? prices.settled[static_cast<std::size_t>(minute)] : std::nan("");
  if (std::isnan(price)) fail("no settled price for {}", utc_text(minute_utc_s).view());
  return price;
}

/// Rows of control cycles, without the last row of a clean stop (release only).
std::vector<std::size_t> cycle_rows(const CsvTable& log) {
  const std::size_t mode = log.column("mode");
  std::vector<std::size_t> rows;
  for (std::size_t r = 0; r < log.row_count(); ++r) {
    if (log.text(r, mode) != "stopping") rows.push_back(r);
  }
  if (rows.empty()) fail("the edge's log has no control cycle");
  return rows;
}

/// From the first control cycle to the end of the last.
Account battery_account(const CsvTable& record, std::int64_t begin_utc_s, std::int64_t end_utc_s,
                        const MinuteSeries& prices, const BatteryParameters& battery) {
  const std::size_t minute = record.column("minute_utc");
  const std::size_t energy = record.column("energy_wh");
  const std::size_t soc = record.column("soc");
  Account account;
  for (std::size_t r = 0; r < record.row_count(); ++r) {
    const std::int64_t utc_s = record.utc_s(r, minute);
    if (utc_s < begin_utc_s || utc_s >= end_utc_s) continue;
    account.add(battery, record.number(r, energy), settled_at(prices, utc_s));
    account.soc_end_frac = record.number(r, soc);
  }
  return account;
}

/// Expected energy of each order, from the SoC that the edge read.
Account edge_account(const CsvTable& log, const std::vector<std::size_t>& rows,
                     const MinuteSeries& prices, const BatteryParameters& battery) {
  const std::size_t utc = log.column("utc");
  const std::size_t soc = log.column("soc_e4");
  const std::size_t power = log.column("ordered_power_w");
  const std::size_t written = log.column("written");
  Account account;
  for (const std::size_t r : rows) {
    const double soc_frac = log.number(r, soc) / kSocFullE4;
    const double wanted_w = log.number(r, written) != 0 ? log.number(r, power) : 0.0;
    const BatteryStep step = battery_step(battery, soc_frac, wanted_w, kHoursPerStep);
    for (int m = 0; m < kMinutesPerStep; ++m) {
      account.add(battery, step.power_w / 60, settled_at(prices, log.utc_s(r, utc) + 60 * m));
    }
    account.soc_end_frac = step.soc_frac;
  }
  return account;
}

Latency latency_of(const CsvTable& log, const std::vector<std::size_t>& rows,
                   std::string_view name) {
  const std::size_t column = log.column(name);
  std::vector<double> values;
  for (const std::size_t r : rows) {
    const double value = log.number(r, column);
    if (value > 0) values.push_back(value);  // 0: no write in that control cycle
  }
  if (values.empty()) return {};
  std::ranges::sort(values);
  return {values[values.size() / 2], values[values.size() * 99 / 100], values.back()};
}

}  // namespace

void Account::add(const BatteryParameters& battery, double energy_wh, double settled_eur_per_mwh) {
  charged_wh += std::max(energy_wh, 0.0);
  discharged_wh += std::max(-energy_wh, 0.0);
  profit_eur -= exchange_cost_eur(battery, energy_wh / kWattsPerMegawatt, settled_eur_per_mwh);
}

RunSettlement settle(const CsvTable& battery_record, const CsvTable& edge_log,
                     const MinuteSeries& prices, const BatteryParameters& battery) {
  const std::vector<std::size_t> rows = cycle_rows(edge_log);
  const std::size_t utc = edge_log.column("utc");
  const std::size_t mode = edge_log.column("mode");
  RunSettlement result;
  result.battery =
      battery_account(battery_record, edge_log.utc_s(rows.front(), utc),
                      edge_log.utc_s(rows.back(), utc) + kSecondsPerStep, prices, battery);
  result.edge = edge_account(edge_log, rows, prices, battery);
  result.cycles = rows.size();
  result.cycles_running = static_cast<std::size_t>(std::ranges::count_if(
      rows, [&](std::size_t r) { return edge_log.text(r, mode) == "running"; }));
  result.decision = latency_of(edge_log, rows, "decision_us");
  result.write = latency_of(edge_log, rows, "write_us");
  result.total = latency_of(edge_log, rows, "total_us");
  return result;
}

}  // namespace bess
