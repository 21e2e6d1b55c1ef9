// What ends each reason: one case a reason, so that a new one does not compile without its own.
#include <cstdio>

#include "edge/control/policy.h"
#include "edge/control/quarter_hour_energy.h"
#include "edge/why/explanation.h"
#include "edge/why/local_text.h"
#include "shared/host/text.h"

namespace bess {
namespace {

double percent(std::int32_t soc_e4) { return soc_e4 / 100.0; }

/// Names of the rules that have a say at this point.
std::string rules_at(const CycleRecord& record) {
  const std::int32_t price_centi = record.price.price_centi_eur_per_mwh;
  const LocalMinute now = local_minute_of(record.utc_s);
  const LatticeState state =
      make_lattice_state(now, record.context_class, record.measurement.soc_e4, price_centi);
  std::string names;
  for (int i = 0; i < guard_rule_count(); ++i) {
    if (!guard_rule_holds(i, now, state, price_centi)) continue;
    names.append(names.empty() ? "" : ", ").append(guard_rule_name(i));
  }
  return names;
}

std::string end_of_reserve(const CycleRecord& record, const GuardSettings& guard) {
  return formatted("until the SoC is above %.1f %%, or the reserve of another hour is lower",
                   percent(record.reserve_soc_e4 + guard.soc_hysteresis_e4));
}

}  // namespace

std::string what_ends(const CycleRecord& record, const ControlSettings& settings) {
  const GuardSettings& guard = settings.guard;
  if (record.is_tripped && is_stop_reason(record.reason)) {
    return formatted("tripped at %s: until a person has looked and says `bess-edge clear --yes`",
                     local_text(record.trip.utc_s).c_str());
  }
  switch (record.reason) {
    case Reason::kStopRequested:
    case Reason::kHandOver:
      return "until a bess-edge is started again";
    case Reason::kClock:
      return "until NTP has set this machine's clock";
    case Reason::kLink:
      return "until the battery can be read";
    case Reason::kAlarm:
      return "until the battery's own alarm is gone";
    case Reason::kTemperature:
      return formatted("until all of it is between %.1f and %.1f °C",
                       guard.temperature_min_deci_c / 10.0, guard.temperature_max_deci_c / 10.0);
    case Reason::kOffGrid:
      return "until the battery is back on the grid";
    case Reason::kWrongDirection:
    case Reason::kUncontrolledPower:
    case Reason::kSocMismatch:
    case Reason::kStateLost:
      return "until a person has looked and says `bess-edge clear --yes`";
    case Reason::kOtherMaster:
    case Reason::kOrdersFail:
    case Reason::kNoAnswer:
    case Reason::kBatteryCare:
      return "tried again after 10 minutes, then 20, up to 6 hours, until it works";
    case Reason::kCapacity:
      return "until it reports the capacity that is configured";
    case Reason::kSocJump:
      return "until three readings of the SoC agree";
    case Reason::kNoPrice:
    case Reason::kPriceAge:
    case Reason::kPriceQuarterHour:
      return formatted("until there is a price that is at most %d s old", guard.price_age_s_max);
    case Reason::kFrozenPrice:
      return "until the price moves";
    case Reason::kSocFull:
      return formatted("until the SoC is below %.1f %%",
                       percent(guard.soc_max_e4 - guard.soc_hysteresis_e4));
    case Reason::kSocEmpty:
      return formatted("until the SoC is above %.1f %%",
                       percent(guard.soc_min_e4 + guard.soc_hysteresis_e4));
    case Reason::kReserve:
      return end_of_reserve(record, guard);
    case Reason::kCycleBudget:
      return "until local midnight";
    case Reason::kReversalCap:
      return formatted("until fewer than %d changes of direction lie in the last hour",
                       settings.reversals_per_hour_max);
    case Reason::kPowerLimit:
      return "as long as the battery itself takes or gives no more";
    case Reason::kOutsideLimit:
      return "until the limit from outside lapses or is taken away";
    case Reason::kMeterLost:
      return "until the meter can be read";
    case Reason::kMeterMismatch:
      return formatted("tried again with an eighth of the power at %s",
                       local_text(record.site.trust.pause_until_utc_s).c_str());
    case Reason::kImportLimit:
    case Reason::kExportLimit:
      return "as long as the house leaves no more of the connection";
    case Reason::kQuarterHourPeak:
      return formatted(
          "until the quarter-hour is over at %s",
          local_clock_text((quarter_hour_of(record.utc_s) + 1) * kQuarterHourS).c_str());
    case Reason::kRamp:
      return formatted("%d W more each cycle", guard.ramp_w_max);
    case Reason::kHeld:
      return formatted("until %s; `bess-edge hold --release` ends it before",
                       local_text(record.hold.until_utc_s).c_str());
    case Reason::kRule:
      return "as long as it holds: " + rules_at(record);
    case Reason::kPriceLow:
      return formatted("until the price is above %d EUR/MWh", guard.thresholds.low_eur_per_mwh);
    case Reason::kPriceHigh:
      return formatted("until the price is below %d EUR/MWh", guard.thresholds.high_eur_per_mwh);
    case Reason::kFullCharge:
      return "until the SoC is at 99.5 %";
    case Reason::kStudent:
      break;
  }
  return {};
}

}  // namespace bess
