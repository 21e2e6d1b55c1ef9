#include "edge/records/log/health.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "edge/core/control/reasons.h"
#include "edge/core/control/tick.h"
#include "edge/records/log/log_text.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// A full, empty or cold battery rests for a while; one that never answers does not listen.
constexpr std::int64_t kUnansweredOrdersMax = 5;
constexpr std::int64_t kWeakAnswersMax = 1;
/// An hour: a battery that is too cold or too warm may rest as long.
constexpr std::int64_t kLockedReadingsMax = 30;
constexpr std::int64_t kUnplannedSMax = kSecondsPerDay;
/// A trip is four times that (../core/supervision/energy_balance.h).
constexpr std::int64_t kWrongEnergyE6Max = 50'000;

std::string seconds(std::int64_t ms) { return std::to_string(ms / 1'000) + " s"; }

/// The convention of the field: warn at twice the cadence, critical at four times.
void check_age(const HealthInputs& in, std::vector<std::string>& reasons) {
  const std::int64_t cadence_ms = in.status->identity.cadence_ms;
  if (in.age_ms <= 2 * cadence_ms) return;
  const bool is_critical = in.age_ms > 4 * cadence_ms;
  const std::string level = is_critical ? "CRITICAL" : "WARN";
  reasons.push_back(level + ": the last cycle ended " + seconds(in.age_ms) +
                    " ago, one is due every " + seconds(cadence_ms));
}

std::string held_row(double eur_per_mwh) {
  char text[160];
  std::snprintf(text, sizeof text,
                "WARN: prices: a row of %.2f EUR/MWh lies further from the one before than "
                "2300 EUR/MWh; the next one decides whether it counts",
                eur_per_mwh);
  return text;
}

std::string frozen_price(const CycleRecord& last) {
  char text[240];
  std::snprintf(text, sizeof text,
                "WARN: prices: frozen_price, %.2f EUR/MWh has not moved for %d minutes under new "
                "stamps, or for hours only among four values: does the source hang?",
                eur_of(last.price.price_centi_eur_per_mwh), last.standing_price.unchanged_s / 60);
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
    reasons.push_back(
        "WARN: outlook: no day-ahead price of today for more than a day (last answer: " +
        std::string(status_name(last.outlook.feed)) +
        "); planned on what is usual, which earns less: see [outlook]");
  }
}

/// What the supervision of the battery's answers tells without stopping.
void check_findings(const CycleRecord& last, std::vector<std::string>& reasons) {
  const ResponseFindings& found = last.findings;
  if (last.unanswered_orders > kUnansweredOrdersMax) {
    reasons.push_back("WARN: no power flows after " + std::to_string(last.unanswered_orders) +
                      " orders: is the battery full, empty or cold, or does it not listen?");
  }
  if (last.weak_answers > kWeakAnswersMax) {
    reasons.push_back("WARN: less power than ordered in " + std::to_string(last.weak_answers) +
                      " readings: is power_w right, does the battery limit itself?");
  }
  if (found.energy_share_percent != 0) {
    reasons.push_back("WARN: the SoC shows about " + std::to_string(found.energy_share_percent) +
                      " % of the measured energy: is capacity_wh right, does the power arrive?");
  }
  if (found.wrong_energy_e6 >= kWrongEnergyE6Max) {
    reasons.push_back("WARN: the battery sometimes does not follow its orders: " +
                      std::to_string(found.wrong_energy_e6 / 10'000) +
                      " % of its capacity flowed against or beyond orders; a trip at 20 %");
  }
  if (found.rest_loss_w != 0) {
    reasons.push_back("WARN: at 0 W, or besides its orders, the battery " +
                      std::string(found.rest_loss_w > 0 ? "loses" : "gains") + " about " +
                      std::to_string(std::abs(found.rest_loss_w)) + " W: what else drives it?");
  }
  if (found.locked_readings > kLockedReadingsMax) {
    reasons.push_back("WARN: by its own limits the battery may neither charge nor discharge, in " +
                      std::to_string(found.locked_readings) + " readings: see its own display");
  }
  if (found.ramp_w_per_s != 0) {
    reasons.push_back("WARN: the battery is slower than its map says, at most " +
                      std::to_string(found.ramp_w_per_s) +
                      " W/s from an order on: bess-edge commission tells whether by lag or by "
                      "ramp, and what to set");
  }
}

std::string meaning_of(Reason reason) {
  const ReasonInfo& info = info_of(reason);
  return std::string(": ") + info.meaning + "; look at " + info.look_at;
}

/// Of a number as records have it: 1 + index, 0 = none.
std::string point_name(const RunIdentity& identity, int number) {
  const bool is_known = number > 0 && number <= identity.point_names.size();
  return is_known ? std::string(identity.point_names[number - 1].view()) : "";
}

/// One line an outage: once it has led to a safe mode, that line names what failed.
void check_answers(const RunStatus& status, std::vector<std::string>& reasons) {
  const CycleRecord& last = status.totals.last;
  std::vector<std::string> failed;
  if (last.battery_status != Status::kOk) {
    failed.push_back("battery: no usable answer, " + std::string(status_name(last.battery_status)));
  }
  const std::string lost = point_name(status.identity, last.measurement.lost_point);
  if (!lost.empty()) failed.push_back("battery: " + lost + " could not be read");
  if (last.price.status != Status::kOk) {
    failed.push_back("prices: no usable answer, " + std::string(status_name(last.price.status)));
  }
  if (last.mode == Mode::kRunning) {
    for (const std::string& what : failed) reasons.push_back("WARN: " + what);
    return;
  }
  std::string line = "WARN: mode is " + std::string(mode_name(last.mode)) + ", reason " +
                     std::string(reason_name(last.reason)) + meaning_of(last.reason);
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
        "WARN: meter: it does not step with the battery, and is not believed: frozen, inverted, of "
        "another phase or ratio? Or is the battery's own power wrong?");
  }
  if (site.house_is_implausible) {
    reasons.push_back("WARN: meter: house " + std::to_string(house_w_of(last)) +
                      " W: a sign, the phase or the meter's place is wrong, or [meter] pv_w_max");
  }
  if (site.limit_status == Status::kTimeout) {
    reasons.emplace_back(
        "WARN: the outside limit has lapsed or was never set: 0 W until a new one");
  } else if (site.limit_status != Status::kOk) {
    reasons.emplace_back(
        "WARN: the file of [limits] cannot be read or understood: 0 W until it can");
  }
}

void check_cycle(const RunStatus& status, std::vector<std::string>& reasons) {
  const CycleRecord& last = status.totals.last;
  if (last.is_tripped) {
    reasons.push_back("CRITICAL: tripped, " + std::string(reason_name(last.trip.reason)) +
                      ": find out why (bess-edge log), then bess-edge clear --yes");
  }
  check_answers(status, reasons);
  const std::string cut = point_name(status.identity, last.measurement.cut_point);
  if (!cut.empty()) {
    reasons.push_back("WARN: battery: " + cut +
                      " is beyond its range, and taken for the end of it");
  }
  if (last.measurement.warning) {
    reasons.emplace_back("WARN: the battery warns, see its own display");
  }
  check_findings(last, reasons);
  if (last.lost_orders.is_found) {
    reasons.push_back("WARN: " + std::to_string(last.lost_orders.lost) + " of the last " +
                      std::to_string(last.lost_orders.judged) +
                      " orders were replaced or ended before their time: who else writes to the "
                      "battery, or does it end them?");
  }
  check_prices(last, reasons);
  if (last.hold.unreadable) {
    reasons.emplace_back("WARN: the hold file is not readable and not followed: bess-edge hold");
  }
  check_site(last, reasons);
}

/// Of the state folder's device.
void check_wear(const CardWear& wear, std::vector<std::string>& reasons) {
  if (wear.used_life_percent > kUsedLifePercentMax) {
    reasons.push_back("WARN: the card has used up to " + std::to_string(wear.used_life_percent) +
                      " % of its life: replace it before it fails");
  }
  if (wear.spare_level >= 2) {
    reasons.emplace_back(wear.spare_level >= 3
                             ? "CRITICAL: the card has used 90 % of its spare blocks and will "
                               "take no more before long: replace it now"
                             : "WARN: the card has used 80 % of its spare blocks: replace it "
                               "before it fails");
  }
  if (wear.file_system_errors > 0) {
    reasons.push_back("WARN: the kernel has counted " + std::to_string(wear.file_system_errors) +
                      " errors in the state folder's file system: is the card dying? (dmesg)");
  }
}

}  // namespace

Health assess_health(const HealthInputs& in) {
  if (!in.is_running) {
    return {HealthLevel::kNotRunning, {"CRITICAL: no bess-edge runs with this configuration"}};
  }
  Health health;
  const RunTotals totals = in.status != nullptr ? in.status->totals : RunTotals{};
  if (!in.unknown.empty()) {
    health.reasons.push_back("CRITICAL: unknown: " + std::string(in.unknown));
  } else if (!in.is_of_this_run || totals.cycles == 0) {
    health.reasons.emplace_back("WARN: started, no cycle has ended yet");
  } else {
    check_cycle(*in.status, health.reasons);
    check_age(in, health.reasons);
  }
  if (!in.update_trouble.empty()) {
    health.reasons.push_back("WARN: update: " + std::string(in.update_trouble));
  }
  if (totals.disk_is_slow) {
    health.reasons.emplace_back("WARN: records not logged, the disk is too slow");
  }
  if (totals.run_folder_is_failing) {
    health.reasons.emplace_back("WARN: the files of [state] run_folder cannot be written");
  }
  check_wear(in.wear, health.reasons);
  // Between the log's record and the status there is a moment in every cycle.
  if (in.cycles_behind > 1) {
    health.reasons.push_back("WARN: the status is " + std::to_string(in.cycles_behind) +
                             " cycles behind the log, is the disk full or read-only?");
  } else if (totals.disk_is_failing) {
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
