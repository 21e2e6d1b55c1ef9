#include "edge/records/log/health.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>

#include "edge/core/control/reasons.h"
#include "edge/core/control/tick.h"
#include "edge/core/supervision/energy_balance.h"
#include "edge/records/log/alerts.h"
#include "edge/records/log/log_text.h"
#include "shared/local_time.h"
#include "shared/units_and_limits.h"

namespace bess {
namespace {

/// A full, empty or cold battery is idle for some time; more orders without power are a fault.
constexpr std::int64_t kUnansweredOrdersMax = 5;
constexpr std::int64_t kWeakAnswersMax = 1;
/// An hour: a battery that is too cold or too warm may be idle that long.
constexpr std::int64_t kLockedReadingsMax = 30;
constexpr std::int64_t kUnplannedSMax = kSecondsPerDay;

using Alerts = std::vector<HealthAlert>;

void warn(Alerts& alerts, Alert alert, const std::string& found = "", bool is_critical = false) {
  alerts.push_back({info_of(alert).code, alert_line(alert, found, is_critical)});
}

std::string since(std::int64_t utc_s) { return " since " + std::string(local_text(utc_s).view()); }

std::string seconds(std::int64_t ms) { return std::to_string(ms / 1'000) + " s"; }

std::string price_text(double eur_per_mwh) {
  char text[48];
  std::snprintf(text, sizeof text, "%.2f EUR/MWh", eur_per_mwh);
  return text;
}

/// Common practice: warning at twice the cadence, critical at four times.
void check_age(const HealthInputs& in, Alerts& alerts) {
  const std::int64_t cadence_ms = in.status->identity.cadence_ms;
  if (in.age_ms <= 2 * cadence_ms) return;
  const std::string found = "the last control cycle ended " + seconds(in.age_ms) +
                            " ago, expected every " + seconds(cadence_ms);
  warn(alerts, Alert::kOverdue, found, in.age_ms > 4 * cadence_ms);
}

void check_prices(const CycleRecord& last, Alerts& alerts) {
  const double eur_per_mwh = eur_of(last.price.price_centi_eur_per_mwh);
  if (last.price.step_held) {
    warn(alerts, Alert::kPriceStep,
         "a step of more than 2300 EUR/MWh, to " +
             price_text(eur_of(last.price.held_centi_eur_per_mwh)) + ", waits for the next row");
  }
  if (last.price_frozen) {
    const std::int32_t unchanged_min = last.standing_price.unchanged_s / 60;
    warn(alerts, Alert::kFrozenPrice,
         unchanged_min >= 30 ? price_text(eur_per_mwh) + " unchanged for " +
                                   std::to_string(unchanged_min) + " min with new time stamps"
                             : "the price has alternated between at most four values for hours");
  }
  if (last.price.has_row && std::fabs(eur_per_mwh) > kUnusualPriceMaxEurPerMwh) {
    warn(alerts, Alert::kUnusualPrice,
         price_text(eur_per_mwh) + " is beyond " + std::to_string(kUnusualPriceMaxEurPerMwh) +
             " EUR/MWh: rare but possible; the price thresholds decide");
  }
  const bool has_outlook = last.outlook.source != OutlookSource::kNone;
  if (has_outlook && last.utc_s - last.outlook.planned_utc_s > kUnplannedSMax) {
    warn(alerts, Alert::kNoDayAhead,
         "no day-ahead price for more than a day (last answer: " +
             std::string(status_name(last.outlook.feed)) +
             "); planning with typical prices, which earns less");
  }
}

/// Findings of the supervision that stop nothing.
void check_findings(const CycleRecord& last, Alerts& alerts) {
  const ResponseFindings& found = last.findings;
  if (last.unanswered_orders > kUnansweredOrdersMax) {
    warn(alerts, Alert::kNoPower,
         "no power after " + std::to_string(last.unanswered_orders) + " orders");
  }
  if (last.weak_answers > kWeakAnswersMax) {
    warn(alerts, Alert::kLowPower,
         "less power than ordered in " + std::to_string(last.weak_answers) + " readings");
  }
  if (found.energy_share_percent != 0) {
    warn(alerts, Alert::kEnergyMismatch,
         "the SoC change is about " + std::to_string(found.energy_share_percent) +
             " % of the measured energy");
  }
  if (found.wrong_energy_e6 >= WrongEnergy::kReportedE6) {
    warn(alerts, Alert::kSetPointIgnored,
         "the battery sometimes does not follow its set point: " +
             std::to_string(found.wrong_energy_e6 / 10'000) +
             " % of its capacity flowed against or beyond orders (trip at 20 %)");
  }
  if (found.rest_loss_w != 0) {
    warn(alerts, Alert::kUnexplainedPower,
         "the battery " + std::string(found.rest_loss_w > 0 ? "loses" : "gains") + " about " +
             std::to_string(std::abs(found.rest_loss_w)) +
             " W at 0 W or in addition to its orders");
  }
  if (found.locked_readings > kLockedReadingsMax) {
    warn(alerts, Alert::kOwnLimits,
         "the battery's own limits allow no power in " + std::to_string(found.locked_readings) +
             " readings");
  }
  if (found.ramp_w_per_s != 0) {
    warn(alerts, Alert::kSlowResponse,
         "the battery follows orders with at most " + std::to_string(found.ramp_w_per_s) +
             " W/s, slower than its map states");
  }
}

/// `number`: 1 + index, 0 = none.
std::string point_name(const RunIdentity& identity, int number) {
  const bool is_known = number > 0 && number <= identity.point_names.size();
  return is_known ? std::string(identity.point_names[number - 1].view()) : "";
}

/// Code of an outage: the same while the mode is still running and after it has changed.
std::string_view outage_code(Reason reason) {
  if (reason == Reason::kLink) return info_of(Alert::kBattery).code;
  const bool is_price = reason == Reason::kNoPrice || reason == Reason::kPriceAge ||
                        reason == Reason::kPriceQuarterHour;
  return is_price ? info_of(Alert::kPrices).code : reason_name(reason);
}

/// One alert per outage: outside mode running, that of the mode says what failed.
void check_answers(const RunStatus& status, Alerts& alerts) {
  const CycleRecord& last = status.totals.last;
  Alerts failed;
  std::string causes;
  const auto fail = [&](Alert alert, const char* what, const std::string& found) {
    warn(failed, alert, found);
    causes += std::string("; ") + what + found;
  };
  if (last.battery_status != Status::kOk) {
    fail(Alert::kBattery, "battery: ",
         std::string(last.has_measurement ? "order not written, " : "no usable answer, ") +
             std::string(status_name(last.battery_status)) +
             since(status.totals.battery_since_utc_s));
  }
  const std::string lost = point_name(status.identity, last.measurement.lost_point);
  if (!lost.empty()) fail(Alert::kPointLost, "battery: ", lost + " could not be read");
  if (last.price.status != Status::kOk) {
    fail(Alert::kPrices, "prices: ",
         std::string(last.price.status == Status::kNoFetcher
                         ? "bess-prices does not run (`systemctl status bess-prices`), "
                         : "no usable answer, ") +
             std::string(status_name(last.price.status)) + since(status.totals.price_since_utc_s));
  }
  if (last.mode == Mode::kRunning) {
    alerts.insert(alerts.end(), failed.begin(), failed.end());
    return;
  }
  if (last.is_tripped && last.reason == last.trip.reason) return;  // check_cycle has it
  const ReasonInfo& reason = info_of(last.reason);
  const std::string_view code = outage_code(last.reason);
  const std::string found = "mode " + std::string(mode_name(last.mode)) + ", reason " +
                            std::string(reason.name) + since(status.totals.reason_since_utc_s) +
                            ": " + reason.meaning + causes;
  alerts.push_back({code, alert_line(code, found, reason.look_at)});
}

void check_site(const CycleRecord& last, Alerts& alerts) {
  const SiteReport& site = last.site;
  if (site.meter_status != Status::kOk) {
    warn(alerts, Alert::kMeter,
         "meter could not be read, " + std::string(status_name(site.meter_status)));
  }
  if (site.trust.is_mismatch) warn(alerts, Alert::kMeterMismatch);
  if (site.house_is_implausible) {
    warn(alerts, Alert::kHousePower,
         "house power of " + std::to_string(house_w_of(last)) + " W is implausible");
  }
  if (site.limit_status == Status::kTimeout) {
    warn(alerts, Alert::kLimitExpired);
  } else if (site.limit_status != Status::kOk) {
    warn(alerts, Alert::kLimitFile);
  }
}

void check_cycle(const RunStatus& status, Alerts& alerts) {
  const CycleRecord& last = status.totals.last;
  if (last.is_tripped) {
    warn(alerts, Alert::kTripped,
         std::string(reason_name(last.trip.reason)) + since(last.trip.utc_s) + ": " +
             info_of(last.trip.reason).meaning,
         true);
  }
  check_answers(status, alerts);
  const std::string cut = point_name(status.identity, last.measurement.cut_point);
  if (!cut.empty()) warn(alerts, Alert::kPointClamped, cut + " is out of range and was clamped");
  if (last.measurement.warning) warn(alerts, Alert::kBatteryWarning);
  check_findings(last, alerts);
  if (last.lost_orders.is_found) {
    warn(alerts, Alert::kLostOrders,
         std::to_string(last.lost_orders.lost) + " of the last " +
             std::to_string(last.lost_orders.judged) + " orders were replaced or ended early");
  }
  check_prices(last, alerts);
  if (last.hold.unreadable) warn(alerts, Alert::kHoldFile);
  check_site(last, alerts);
}

/// Of the state folder's device.
void check_wear(const StorageWear& wear, Alerts& alerts) {
  if (wear.used_life_percent > kUsedLifePercentMax) {
    warn(alerts, Alert::kStorageLife,
         "storage has used up to " + std::to_string(wear.used_life_percent) + " % of its life");
  }
  if (wear.spare_level >= 2) {
    const bool is_critical = wear.spare_level >= 3;
    warn(alerts, Alert::kStorageSpare,
         "storage has used " + std::string(is_critical ? "90" : "80") + " % of its spare blocks",
         is_critical);
  }
  if (wear.file_system_errors > 0) {
    warn(alerts, Alert::kFileSystem,
         "the kernel has counted " + std::to_string(wear.file_system_errors) +
             " errors in the state folder's file system");
  }
}

}  // namespace

Health assess_health(const HealthInputs& in) {
  Health health;
  if (!in.is_running) {
    warn(health.alerts, Alert::kNoController, "", true);
    health.level = HealthLevel::kNotRunning;
    return health;
  }
  const RunTotals totals = in.status != nullptr ? in.status->totals : RunTotals{};
  if (!in.unknown.empty()) {
    warn(health.alerts, Alert::kUnknown, std::string(in.unknown), true);
  } else if (!in.is_of_this_run || totals.cycles == 0) {
    warn(health.alerts, Alert::kStarting);
  } else {
    check_cycle(*in.status, health.alerts);
    check_age(in, health.alerts);
  }
  if (!in.update_trouble.empty()) {
    warn(health.alerts, Alert::kUpdate, std::string(in.update_trouble));
  }
  if (totals.disk_is_slow) warn(health.alerts, Alert::kDiskSlow);
  if (totals.run_folder_is_failing) warn(health.alerts, Alert::kRunFolder);
  check_wear(in.wear, health.alerts);
  // Between log record and status, one control cycle behind is normal.
  if (in.cycles_behind > 1) {
    warn(health.alerts, Alert::kStatusBehind,
         "the status is " + std::to_string(in.cycles_behind) + " control cycles behind the log");
  } else if (totals.disk_is_failing) {
    warn(health.alerts, Alert::kLogUnwritable);
  } else if (in.disk_is_full) {
    warn(health.alerts, Alert::kDiskFull);
  }
  if (!health.alerts.empty()) health.level = HealthLevel::kDegraded;
  return health;
}

std::string_view health_name(HealthLevel level) {
  if (level == HealthLevel::kOk) return "ok";
  return level == HealthLevel::kDegraded ? "degraded" : "not running";
}

}  // namespace bess
