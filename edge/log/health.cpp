#include "edge/log/health.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "edge/control/reasons.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// A full, empty or cold battery rests for a while; one that never answers does not listen.
constexpr std::int64_t kUnansweredOrdersMax = 5;
constexpr std::int64_t kWeakAnswersMax = 1;
/// An hour: a battery that is too cold or too warm may rest as long.
constexpr std::int64_t kLockedReadingsMax = 30;
constexpr std::int64_t kUnplannedSMax = 86'400;
/// A trip is four times that (supervision/energy_balance.h).
constexpr std::int64_t kWrongEnergyE6Max = 50'000;

std::string seconds(std::int64_t ms) { return std::to_string(ms / 1'000) + " s"; }

/// The convention of the field: warn at twice the cadence, critical at four times.
void check_age(const HealthInputs& in, std::vector<std::string>& reasons) {
  if (in.age_ms <= 2 * in.cadence_ms) return;
  const bool is_critical = in.age_ms > 4 * in.cadence_ms;
  const std::string level = is_critical ? "CRITICAL" : "WARN";
  reasons.push_back(level + ": the last cycle ended " + seconds(in.age_ms) +
                    " ago, one is due every " + seconds(in.cadence_ms));
}

std::string held_row(double eur_per_mwh) {
  char text[160];
  std::snprintf(text, sizeof text,
                "WARN: prices: a row of %.2f EUR/MWh lies further from the one before than "
                "2300 EUR/MWh; the next one decides whether it counts",
                eur_per_mwh);
  return text;
}

std::string frozen_price(const HealthInputs& in) {
  char text[240];
  std::snprintf(text, sizeof text,
                "WARN: prices: frozen_price, %.2f EUR/MWh has not moved for %lld minutes under new "
                "stamps, or for hours only among four values: does the source hang?",
                in.price_eur_per_mwh, static_cast<long long>(in.price_unchanged_s / 60));
  return text;
}

std::string unusual_price(double eur_per_mwh) {
  char text[160];
  std::snprintf(text, sizeof text,
                "WARN: prices: %.2f EUR/MWh lies beyond %d: rare, and possible; the guard's "
                "thresholds decide",
                eur_per_mwh, kUnusualPriceMaxEurPerMwh);
  return text;
}

void check_prices(const HealthInputs& in, std::vector<std::string>& reasons) {
  if (in.price_step_held) reasons.push_back(held_row(in.held_eur_per_mwh));
  if (in.price_frozen) reasons.push_back(frozen_price(in));
  if (in.has_price && std::fabs(in.price_eur_per_mwh) > kUnusualPriceMaxEurPerMwh) {
    reasons.push_back(unusual_price(in.price_eur_per_mwh));
  }
  if (in.unplanned_s > kUnplannedSMax) {
    reasons.push_back(
        "WARN: outlook: no day-ahead price of today for more than a day (last answer: " +
        std::string(in.day_ahead_status) +
        "); planned on what is usual, which earns less: see [outlook]");
  }
}

/// What the supervision of the battery's answers tells without stopping.
void check_findings(const HealthInputs& in, std::vector<std::string>& reasons) {
  if (in.unanswered_orders > kUnansweredOrdersMax) {
    reasons.push_back("WARN: no power flows after " + std::to_string(in.unanswered_orders) +
                      " orders: is the battery full, empty or cold, or does it not listen?");
  }
  if (in.weak_answers > kWeakAnswersMax) {
    reasons.push_back("WARN: less power than ordered in " + std::to_string(in.weak_answers) +
                      " readings: is power_w right, does the battery limit itself?");
  }
  if (in.energy_share_percent != 0) {
    reasons.push_back("WARN: the SoC shows about " + std::to_string(in.energy_share_percent) +
                      " % of the measured energy: is capacity_wh right, does the power arrive?");
  }
  if (in.wrong_energy_e6 >= kWrongEnergyE6Max) {
    reasons.push_back("WARN: now and then the battery does not do as it is told: " +
                      std::to_string(in.wrong_energy_e6 / 10'000) +
                      " % of its capacity flowed against or beyond orders; a trip at 20 %");
  }
  if (in.rest_loss_w != 0) {
    reasons.push_back("WARN: at 0 W, or besides its orders, the battery " +
                      std::string(in.rest_loss_w > 0 ? "loses" : "gains") + " about " +
                      std::to_string(std::abs(in.rest_loss_w)) + " W: what else drives it?");
  }
  if (in.locked_readings > kLockedReadingsMax) {
    reasons.push_back("WARN: by its own limits the battery may neither charge nor discharge, in " +
                      std::to_string(in.locked_readings) + " readings: see its own display");
  }
  if (in.ramp_w_per_s != 0) {
    reasons.push_back("WARN: the battery is slower than its map says, at most " +
                      std::to_string(in.ramp_w_per_s) +
                      " W/s from an order on: bess-edge commission tells whether by lag or by "
                      "ramp, and what to set");
  }
}

/// What the reason means and where to look, of a name in the table of reasons.
std::string meaning_of(std::string_view reason) {
  for (const ReasonInfo& info : kReasons) {
    if (info.name == reason) return std::string(": ") + info.meaning + "; look at " + info.look_at;
  }
  return "";
}

/// One line an outage: once it has led to a safe mode, that line names what failed.
void check_answers(const HealthInputs& in, std::vector<std::string>& reasons) {
  std::vector<std::string> failed;
  if (in.battery_status != "ok") {
    failed.push_back("battery: no usable answer, " + std::string(in.battery_status));
  }
  if (!in.lost_reading.empty()) {
    failed.push_back("battery: " + std::string(in.lost_reading) + " could not be read");
  }
  if (in.price_status != "ok") {
    failed.push_back("prices: no usable answer, " + std::string(in.price_status));
  }
  if (in.mode == "running") {
    for (const std::string& what : failed) reasons.push_back("WARN: " + what);
    return;
  }
  std::string line = "WARN: mode is " + std::string(in.mode) + ", reason " +
                     std::string(in.reason) + meaning_of(in.reason);
  for (const std::string& what : failed) line += "; " + what;
  reasons.push_back(line);
}

void check_cycle(const HealthInputs& in, std::vector<std::string>& reasons) {
  if (in.trip != "none") {
    reasons.push_back("CRITICAL: tripped, " + std::string(in.trip) +
                      ": find out why (bess-edge log), then bess-edge clear --yes");
  }
  check_answers(in, reasons);
  if (!in.cut_reading.empty()) {
    reasons.push_back("WARN: battery: " + std::string(in.cut_reading) +
                      " is beyond its range, and taken for the end of it");
  }
  if (in.battery_warns) reasons.emplace_back("WARN: the battery warns, see its own display");
  check_findings(in, reasons);
  if (in.orders_are_lost) {
    reasons.push_back("WARN: " + std::to_string(in.lost_orders) + " of the last " +
                      std::to_string(in.judged_orders) +
                      " orders were replaced or ended before their time: who else writes to the "
                      "battery, or does it end them?");
  }
  check_prices(in, reasons);
  if (in.hold_is_unreadable) {
    reasons.emplace_back("WARN: the hold file is not readable and not followed: bess-edge hold");
  }
  if (in.meter_status != "ok") {
    reasons.push_back("WARN: meter: " + std::string(in.meter_status));
  }
  if (in.meter_is_mismatch) {
    reasons.emplace_back(
        "WARN: meter: it does not step with the battery, and is not believed: frozen, inverted, of "
        "another phase or ratio? Or is the battery's own power wrong?");
  }
  if (in.house_is_implausible) {
    reasons.push_back("WARN: meter: house " + std::to_string(in.house_w) +
                      " W: a sign, the phase or the meter's place is wrong, or [meter] pv_w_max");
  }
  if (in.limit_status == "timeout") {
    reasons.emplace_back(
        "WARN: the outside limit has lapsed or was never set: 0 W until a new one");
  } else if (in.limit_status != "ok") {
    reasons.emplace_back(
        "WARN: the file of [limits] cannot be read or understood: 0 W until it can");
  }
}

}  // namespace

Health assess_health(const HealthInputs& in) {
  if (!in.is_running) {
    return {HealthLevel::kNotRunning, {"CRITICAL: no bess-edge runs with this configuration"}};
  }
  Health health;
  if (!in.unknown.empty()) {
    health.reasons.push_back("CRITICAL: unknown: " + std::string(in.unknown));
  } else if (!in.is_of_this_run || in.cycles == 0) {
    health.reasons.emplace_back("WARN: started, no cycle has ended yet");
  } else {
    check_cycle(in, health.reasons);
    check_age(in, health.reasons);
  }
  if (!in.update_trouble.empty()) {
    health.reasons.push_back("WARN: update: " + std::string(in.update_trouble));
  }
  if (in.disk_is_slow)
    health.reasons.emplace_back("WARN: records not logged, the disk is too slow");
  if (in.run_folder_is_failing) {
    health.reasons.emplace_back("WARN: the files of [state] run_folder cannot be written");
  }
  if (in.disk_used_life_percent > 0) {
    health.reasons.push_back("WARN: the card has used up to " +
                             std::to_string(in.disk_used_life_percent) +
                             " % of its life: replace it before it fails");
  }
  if (in.disk_spare_level >= 2) {
    health.reasons.emplace_back(
        in.disk_spare_level >= 3 ? "CRITICAL: the card has used 90 % of its spare blocks and will "
                                   "take no more before long: replace it now"
                                 : "WARN: the card has used 80 % of its spare blocks: replace it "
                                   "before it fails");
  }
  if (in.file_system_errors > 0) {
    health.reasons.push_back(
        "WARN: the kernel has counted " + std::to_string(in.file_system_errors) +
        " errors in the state folder's file system: is the card dying? (dmesg)");
  }
  // Between the log's record and the status there is a moment in every cycle.
  if (in.cycles_behind > 1) {
    health.reasons.push_back("WARN: status.json is " + std::to_string(in.cycles_behind) +
                             " cycles behind the log, is the disk full or read-only?");
  } else if (in.disk_is_failing) {
    health.reasons.emplace_back("WARN: the log cannot be written, is the disk full or read-only?");
  } else if (in.disk_is_full) {
    health.reasons.emplace_back("WARN: the disk of the state folder is full or read-only");
  }
  if (!health.reasons.empty()) health.level = HealthLevel::kDegraded;
  return health;
}

std::string_view health_name(HealthLevel level) {
  switch (level) {
    case HealthLevel::kOk:
      return "ok";
    case HealthLevel::kDegraded:
      return "degraded";
    case HealthLevel::kNotRunning:
      break;
  }
  return "not running";
}

}  // namespace bess
