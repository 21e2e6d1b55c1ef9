#include "edge/records/log/health.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "edge/core/control/reasons.h"
#include "edge/core/control/tick.h"
#include "edge/records/log/log_text.h"
#include "shared/local_text.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// A full, empty or cold battery is idle for some time; more orders without power are a fault.
constexpr std::int64_t kUnansweredOrdersMax = 5;
constexpr std::int64_t kWeakAnswersMax = 1;
/// An hour: a battery that is too cold or too warm may be idle that long.
constexpr std::int64_t kLockedReadingsMax = 30;
constexpr std::int64_t kUnplannedSMax = kSecondsPerDay;
/// A quarter of the trip level (../core/supervision/energy_balance.h).
constexpr std::int64_t kWrongEnergyE6Max = 50'000;

std::string since(std::int64_t utc_s) { return " since " + std::string(local_text(utc_s).view()); }

std::string seconds(std::int64_t ms) { return std::to_string(ms / 1'000) + " s"; }

/// Common practice: warning at twice the cadence, critical at four times.
void check_age(const HealthInputs& in, std::vector<std::string>& reasons) {
  const std::int64_t cadence_ms = in.status->identity.cadence_ms;
  if (in.age_ms <= 2 * cadence_ms) return;
  const bool is_critical = in.age_ms > 4 * cadence_ms;
  const std::string level = is_critical ? "CRITICAL" : "WARN";
  reasons.push_back(level + ": the last control cycle ended " + seconds(in.age_ms) +
                    " ago, expected every " + seconds(cadence_ms) + ": check its journal");
}

std::string held_row(double eur_per_mwh) {
  char text[160];
  std::snprintf(text, sizeof text,
                "WARN: prices: jump to %.2f EUR/MWh, more than 2300 EUR/MWh: waiting for the next "
                "row to confirm it",
                eur_per_mwh);
  return text;
}

std::string frozen_price(const CycleRecord& last) {
  char text[240];
  std::snprintf(text, sizeof text,
                "WARN: prices: frozen_price, %.2f EUR/MWh unchanged for %d min with new time "
                "stamps, or only four values for hours: check that the source updates",
                eur_of(last.price.price_centi_eur_per_mwh), last.standing_price.unchanged_s / 60);
  return text;
}

std::string unusual_price(double eur_per_mwh) {
  char text[160];
  std::snprintf(text, sizeof text,
                "WARN: prices: %.2f EUR/MWh is beyond %d EUR/MWh: rare but possible; the price "
                "thresholds decide",
                eur_per_mwh, kUnusualPriceMaxEurPerMwh);
  return text;
}

void check_prices(const CycleRecord& last, std::vector<std::string>& reasons) {
  const double eur_per_mwh = eur_of(last.price.price_centi_eur_per_mwh);
  if (last.price.step_held) {
    reasons.push_back(held_row(eur_of(last.price.held_centi_eur_per_mwh)));
  }
  if (last.price_frozen) reasons.push_back(frozen_price(last));
  if (last.price.has_row && std::fabs(eur_per_mwh) > kUnusualPriceMaxEurPerMwh) {
    reasons.push_back(unusual_price(eur_per_mwh));
  }
  const bool has_outlook = last.outlook.source != OutlookSource::kNone;
  if (has_outlook && last.utc_s - last.outlook.planned_utc_s > kUnplannedSMax) {
    reasons.push_back("WARN: outlook: no day-ahead price for more than a day (last answer: " +
                      std::string(status_name(last.outlook.feed)) +
                      "); planning with typical prices, which earns less: check [outlook]");
  }
}

/// Findings of the supervision that stop nothing.
void check_findings(const CycleRecord& last, std::vector<std::string>& reasons) {
  const ResponseFindings& found = last.findings;
  if (last.unanswered_orders > kUnansweredOrdersMax) {
    reasons.push_back("WARN: no power after " + std::to_string(last.unanswered_orders) +
                      " orders: is the battery full, empty, cold or in standby?");
  }
  if (last.weak_answers > kWeakAnswersMax) {
    reasons.push_back("WARN: less power than ordered in " + std::to_string(last.weak_answers) +
                      " readings: check power_w and the battery's own limits");
  }
  if (found.energy_share_percent != 0) {
    reasons.push_back("WARN: the SoC change is about " +
                      std::to_string(found.energy_share_percent) +
                      " % of the measured energy: check capacity_wh and the measured power");
  }
  if (found.wrong_energy_e6 >= kWrongEnergyE6Max) {
    reasons.push_back("WARN: the battery sometimes does not follow its set point: " +
                      std::to_string(found.wrong_energy_e6 / 10'000) +
                      " % of its capacity flowed against or beyond orders; trips at 20 %");
  }
  if (found.rest_loss_w != 0) {
    reasons.push_back("WARN: the battery " +
                      std::string(found.rest_loss_w > 0 ? "loses" : "gains") + " about " +
                      std::to_string(std::abs(found.rest_loss_w)) +
                      " W at 0 W or in addition to its orders: what else drives it?");
  }
  if (found.locked_readings > kLockedReadingsMax) {
    reasons.push_back("WARN: the battery's own limits allow no power in " +
                      std::to_string(found.locked_readings) + " readings: check its display");
  }
  if (found.ramp_w_per_s != 0) {
    reasons.push_back("WARN: the battery is slower than its map, at most " +
                      std::to_string(found.ramp_w_per_s) +
                      " W/s after an order: bess-edge commission measures lag and ramp, and prints "
                      "the settings");
  }
}

std::string meaning_of(Reason reason) {
  const ReasonInfo& info = info_of(reason);
  return std::string(": ") + info.meaning + "; look at " + info.look_at;
}

/// `number`: 1 + index, 0 = none.
std::string point_name(const RunIdentity& identity, int number) {
  const bool is_known = number > 0 && number <= identity.point_names.size();
  return is_known ? std::string(identity.point_names[number - 1].view()) : "";
}

/// One line per outage: outside mode running, the line of the mode names what failed.
void check_answers(const RunStatus& status, std::vector<std::string>& reasons) {
  const CycleRecord& last = status.totals.last;
  std::vector<std::string> failed;
  if (last.battery_status != Status::kOk) {
    failed.push_back("battery: no usable answer, " + std::string(status_name(last.battery_status)) +
                     since(status.totals.battery_since_utc_s));
  }
  const std::string lost = point_name(status.identity, last.measurement.lost_point);
  if (!lost.empty()) failed.push_back("battery: " + lost + " could not be read");
  if (last.price.status != Status::kOk) {
    failed.push_back("prices: no usable answer, " + std::string(status_name(last.price.status)) +
                     since(status.totals.price_since_utc_s));
  }
  if (last.mode == Mode::kRunning) {
    for (const std::string& what : failed) reasons.push_back("WARN: " + what);
    return;
  }
  std::string line = "WARN: mode is " + std::string(mode_name(last.mode)) + ", reason " +
                     std::string(reason_name(last.reason)) +
                     since(status.totals.reason_since_utc_s) + meaning_of(last.reason);
  for (const std::string& what : failed) line += "; " + what;
  reasons.push_back(line);
}

void check_site(const CycleRecord& last, std::vector<std::string>& reasons) {
  const SiteReport& site = last.site;
  if (site.meter_status != Status::kOk) {
    reasons.push_back("WARN: meter: " + std::string(status_name(site.meter_status)));
  }
  if (site.trust.is_mismatch) {
    reasons.emplace_back(
        "WARN: meter: does not respond to battery steps and is ignored: frozen, inverted, wrong "
        "phase or ratio, or wrong battery power?");
  }
  if (site.house_is_implausible) {
    reasons.push_back(
        "WARN: meter: house " + std::to_string(house_w_of(last)) +
        " W is implausible: check signs, phase and position of the meter, and [meter] "
        "pv_w_max");
  }
  if (site.limit_status == Status::kTimeout) {
    reasons.emplace_back(
        "WARN: external limit expired or never set: 0 W until a new limit (bess-edge limit)");
  } else if (site.limit_status != Status::kOk) {
    reasons.emplace_back("WARN: [limits] file unreadable or malformed: 0 W until corrected");
  }
}

void check_cycle(const RunStatus& status, std::vector<std::string>& reasons) {
  const CycleRecord& last = status.totals.last;
  if (last.is_tripped) {
    reasons.push_back("CRITICAL: tripped, " + std::string(reason_name(last.trip.reason)) +
                      since(last.trip.utc_s) +
                      ": check the cause (bess-edge log), then bess-edge clear --yes");
  }
  check_answers(status, reasons);
  const std::string cut = point_name(status.identity, last.measurement.cut_point);
  if (!cut.empty()) {
    reasons.push_back("WARN: battery: " + cut + " is out of range and was clamped");
  }
  if (last.measurement.warning) {
    reasons.emplace_back("WARN: the battery reports a warning: check its display");
  }
  check_findings(last, reasons);
  if (last.lost_orders.is_found) {
    reasons.push_back("WARN: " + std::to_string(last.lost_orders.lost) + " of the last " +
                      std::to_string(last.lost_orders.judged) +
                      " orders were replaced or ended early: is another controller active?");
  }
  check_prices(last, reasons);
  if (last.hold.unreadable) {
    reasons.emplace_back("WARN: hold file unreadable, hold ignored: repeat bess-edge hold");
  }
  check_site(last, reasons);
}

/// Of the state folder's device.
void check_wear(const StorageWear& wear, std::vector<std::string>& reasons) {
  if (wear.used_life_percent > kUsedLifePercentMax) {
    reasons.push_back("WARN: storage has used up to " + std::to_string(wear.used_life_percent) +
                      " % of its life: replace it soon");
  }
  if (wear.spare_level >= 2) {
    reasons.emplace_back(wear.spare_level >= 3
                             ? "CRITICAL: storage has used 90 % of its spare blocks: replace it now"
                             : "WARN: storage has used 80 % of its spare blocks: replace it soon");
  }
  if (wear.file_system_errors > 0) {
    reasons.push_back("WARN: the kernel has counted " + std::to_string(wear.file_system_errors) +
                      " errors in the state folder's file system: check the storage (dmesg)");
  }
}

}  // namespace

Health assess_health(const HealthInputs& in) {
  if (!in.is_running) {
    return {HealthLevel::kNotRunning,
            {"CRITICAL: no controller runs with this configuration: systemctl start bess-edge"}};
  }
  Health health;
  const RunTotals totals = in.status != nullptr ? in.status->totals : RunTotals{};
  if (!in.unknown.empty()) {
    health.reasons.push_back("CRITICAL: unknown: " + std::string(in.unknown));
  } else if (!in.is_of_this_run || totals.cycles == 0) {
    health.reasons.emplace_back("WARN: started; first control cycle not complete");
  } else {
    check_cycle(*in.status, health.reasons);
    check_age(in, health.reasons);
  }
  if (!in.update_trouble.empty()) {
    health.reasons.push_back("WARN: update: " + std::string(in.update_trouble));
  }
  if (totals.disk_is_slow) {
    health.reasons.emplace_back("WARN: log records dropped: disk too slow");
  }
  if (totals.run_folder_is_failing) {
    health.reasons.emplace_back(
        "WARN: files of [state] run_folder cannot be written: check its permissions");
  }
  check_wear(in.wear, health.reasons);
  // Between log record and status, one control cycle behind is normal.
  if (in.cycles_behind > 1) {
    health.reasons.push_back("WARN: the status is " + std::to_string(in.cycles_behind) +
                             " control cycles behind the log: is the disk full or read-only?");
  } else if (totals.disk_is_failing) {
    health.reasons.emplace_back("WARN: the log cannot be written: is the disk full or read-only?");
  } else if (in.disk_is_full) {
    health.reasons.emplace_back(
        "WARN: the disk of [state] folder is full or read-only: free space or remount it");
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
