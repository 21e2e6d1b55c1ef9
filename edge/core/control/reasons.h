// Reasons of a control cycle, one row each, in order of precedence: earlier rows win. A row has
//   enumerator, code on disk, name in log and status, effect on the battery, meaning,
//   what to check, what ends it, with {values} that edge/records/why/reason_end.cpp fills in
// A code is never reused: old logs must keep their meaning. A new row takes the next code.
// shared/manual/guides/troubleshooting.md has the same table, checked by reasons_test.cpp.
#pragma once

#include <cstdint>
#include <string_view>

namespace bess {

#define BESS_REASONS(ROW)                                                                          \
  ROW(kStopRequested, 0, "stop_requested", kRests, "SIGTERM, or `--cycles` are done: released",    \
      "`journalctl -u bess-edge`", "until bess-edge is started again")                             \
  ROW(kHandOver, 15, "hand_over", kRests, "SIGHUP: the order stays in force",                      \
      "`journalctl -u bess-edge`", "until bess-edge is started again")                             \
  ROW(kClock, 1, "clock", kRests, "clock not synchronised by NTP",                                 \
      "check `timedatectl`: NTP service running, server reachable",                                \
      "until NTP has synchronised the clock of this machine")                                      \
  ROW(kLink, 2, "link", kRests, "battery could not be read",                                       \
      "check cable, address and unit id; a second Modbus client?",                                 \
      "until the battery can be read")                                                             \
  ROW(kAlarm, 3, "alarm", kRests, "the battery or its inverter reports a fault",                   \
      "check its own display; the map's `alarms`. Warnings stop nothing: see `status`",            \
      "until the battery's own alarm clears")                                                      \
  ROW(kTemperature, 4, "temperature", kRests,                                                      \
      "battery outside `temperature_min_c` to `temperature_max_c`",                                \
      "check the temperature of the room",                                                         \
      "until all cells are between {temperature_min_c} and {temperature_max_c} °C")                \
  ROW(kOffGrid, 5, "off_grid", kReleases,                                                          \
      "off-grid: released at once, so that the battery can supply the house", "no action",         \
      "until the battery is back on the grid")                                                     \
  ROW(kGridUnknown, 41, "grid_unknown", kReleases,                                                 \
      "grid state unknown: released at once, as if off-grid",                                      \
      "`status` names the register: check gateway, cable and the device's own display",            \
      "until that register can be read")                                                           \
  ROW(kProtectionLost, 42, "protection_lost", kRests,                                              \
      "an alarm, limit or temperature that was readable before could not be read",                 \
      "as `grid_unknown`; after a change of the device `bess-edge commission`",                    \
      "until that register can be read")                                                           \
  ROW(kWrongDirection, 16, "wrong_direction", kReleases, "trip: power against the order",          \
      "check meter, sign and map; `bess-edge commission` again, then `bess-edge clear --yes`",     \
      "until a person checks the battery and runs `bess-edge clear --yes`")                        \
  ROW(kUncontrolledPower, 19, "uncontrolled_power", kReleases,                                     \
      "trip: more power than ordered, or power at 0 W",                                            \
      "look for another controller; check `power_w` and the map's scale; then `bess-edge "         \
      "clear --yes`",                                                                              \
      "until a person checks the battery and runs `bess-edge clear --yes`")                        \
  ROW(kSocMismatch, 20, "soc_mismatch", kReleases,                                                 \
      "trip: the SoC does not change, or does not match the measured power",                       \
      "check for frozen values, capacity and power measurement; then `bess-edge clear --yes`",     \
      "until a person checks the battery and runs `bess-edge clear --yes`")                        \
  ROW(kStateLost, 39, "state_lost", kReleases, "trip: state of earlier runs lost",                 \
      "check the disk under `[state] folder`; then `bess-edge clear --yes`",                       \
      "until a person checks the battery and runs `bess-edge clear --yes`")                        \
  ROW(kOtherMaster, 21, "other_master", kReleases,                                                 \
      "another controller replaces orders (two in a row, or every second or third): released, "    \
      "retried",                                                                                   \
      "look for a second controller: the manufacturer's app, a schedule in the device; "           \
      "`on_other_master`",                                                                         \
      "retried after 10 minutes, then 20, up to 6 hours, until it succeeds")                       \
  ROW(kOrdersFail, 22, "orders_fail", kReleases,                                                   \
      "three orders in a row failed while the battery was readable, or it cannot be read "         \
      "while it follows one; retried",                                                             \
      "check that external control is enabled on the device",                                      \
      "retried after 10 minutes, then 20, up to 6 hours, until it succeeds")                       \
  ROW(kNoAnswer, 23, "no_answer", kReleases,                                                       \
      "no power at mid SoC although ordered, or orders end early (two in a row, or every "         \
      "second or third); retried",                                                                 \
      "check for standby, a blocked battery, orders acknowledged without effect, another "         \
      "controller that writes only a stop",                                                        \
      "retried after 10 minutes, then 20, up to 6 hours, until it succeeds")                       \
  ROW(kBatteryCare, 37, "battery_care", kReleases,                                                 \
      "charges by itself below 12 %, or balances above 95 %: released, retried after 10 min; "     \
      "a trip (uncontrolled_power) after a day",                                                   \
      "no action; if it recurs daily, check the battery's own display",                            \
      "retried after 10 minutes, then 20, up to 6 hours, until it succeeds")                       \
  ROW(kCapacity, 24, "capacity", kReleases, "capacity differs from the configured one",            \
      "check the identity of the battery and `capacity_wh`",                                       \
      "until it reports the configured capacity")                                                  \
  ROW(kSocJump, 25, "soc_jump", kRests,                                                            \
      "SoC changed by more than power explains; 0 W until three readings agree",                   \
      "check the battery's own display", "until three readings of the SoC agree")                  \
  ROW(kNoPrice, 6, "no_price", kRests, "no price yet",                                             \
      "check network and `[price] url`: `bess-prices --check`",                                    \
      "until a price is at most {price_age_s_max} s old")                                          \
  ROW(kPriceAge, 7, "price_age", kRests, "the newest price is too old (`price_age_s_max`)",        \
      "check network and `[price] url`: `bess-prices --check`",                                    \
      "until a price is at most {price_age_s_max} s old")                                          \
  ROW(kPriceQuarterHour, 8, "price_qh", kRests,                                                    \
      "the newest price is from before the previous quarter-hour",                                 \
      "check network and `[price] url`: `bess-prices --check`",                                    \
      "until a price is at most {price_age_s_max} s old")                                          \
  ROW(kFrozenPrice, 36, "frozen_price", kRests,                                                    \
      "the newest price has not changed for `frozen_price_s_max` under new time stamps, or "       \
      "alternated between four values for 2.5 times as long",                                      \
      "check the price source", "until the price changes")                                         \
  ROW(kSocFull, 9, "soc_full", kGoesOn, "at `soc_max`", "none",                                    \
      "until the SoC is below {soc_below_full} %")                                                 \
  ROW(kSocEmpty, 10, "soc_empty", kGoesOn, "at `soc_min`", "none",                                 \
      "until the SoC is above {soc_above_empty} %")                                                \
  ROW(kReserve, 28, "reserve", kGoesOn, "at the `[[reserve]]` of this hour: no discharge", "none", \
      "until the SoC is above {soc_above_reserve} %, or the reserve of another hour is lower")     \
  ROW(kCycleBudget, 17, "cycle_budget", kGoesOn, "`cycles_per_day_max` is used up",                \
      "passes at local midnight", "until local midnight")                                          \
  ROW(kReversalCap, 26, "reversal_cap", kGoesOn,                                                   \
      "one more change between charging and discharging than `reversals_per_hour_max`",            \
      "check the price source: correct prices do not do this",                                     \
      "until the last hour has fewer than {reversals_per_hour_max} changes of direction")          \
  ROW(kPowerLimit, 11, "power_limit", kGoesOn, "the order was cut to the battery's limit", "none", \
      "as long as the battery's own limit is this low")                                            \
  ROW(kOutsideLimit, 30, "outside_limit", kGoesOn,                                                 \
      "another program's limit is in force, has lapsed or cannot be parsed",                       \
      "check `bess-edge status`, the file of `[limits]` and the program that writes it",           \
      "until the limit from outside lapses or is removed")                                         \
  ROW(kMeterLost, 31, "meter_lost", kGoesOn, "no reading of the meter for 30 s: 0 W",              \
      "check cable, address and unit", "until the meter can be read")                              \
  ROW(kMeterMismatch, 38, "meter_mismatch", kGoesOn,                                               \
      "the meter does not step with the battery and is treated as lost: 0 W; after a pause a "     \
      "test at an eighth of the power",                                                            \
      "check whether the meter is frozen, inverted, late, on another phase or has another "        \
      "ratio; the battery's own power; if another device regulates the grid power: `judged = "     \
      "false`",                                                                                    \
      "retried at an eighth of the power at {meter_pause_end}")                                    \
  ROW(kImportLimit, 32, "import_limit", kGoesOn,                                                   \
      "the house load leaves the battery no more import capacity of the connection", "`[meter]`",  \
      "as long as the house leaves no more capacity of the connection")                            \
  ROW(kExportLimit, 33, "export_limit", kGoesOn,                                                   \
      "the house leaves the battery no more export capacity of the connection", "`[meter]`",       \
      "as long as the house leaves no more capacity of the connection")                            \
  ROW(kQuarterHourPeak, 34, "quarter_hour_peak", kGoesOn,                                          \
      "the mean of the quarter-hour would exceed `peak_w_max`; discharging: the charged "          \
      "energy is returned",                                                                        \
      "`[meter]`", "until the quarter-hour is over at {quarter_hour_end}")                         \
  ROW(kRamp, 18, "ramp", kGoesOn, "the order was cut to `ramp_w_max`", "none",                     \
      "{ramp_w_max} W more each control cycle")                                                    \
  ROW(kHeld, 27, "held", kGoesOn, "operator's `bess-edge hold`",                                   \
      "`bess-edge status` shows power and end time",                                               \
      "until {hold_end}; `bess-edge hold --release` ends it earlier")                              \
  ROW(kRule, 35, "rule", kGoesOn, "operator's rule exported with the student",                     \
      "`bess-edge why` names it", "as long as the rule applies: {rules}")                          \
  ROW(kPriceLow, 12, "price_low", kGoesOn,                                                         \
      "at or below `low_price_eur_per_mwh`, against the student's action", "none",                 \
      "until the price is above {low_price} EUR/MWh")                                              \
  ROW(kPriceHigh, 13, "price_high", kGoesOn,                                                       \
      "at or above `high_price_eur_per_mwh`, against the student's action", "none",                \
      "until the price is below {high_price} EUR/MWh")                                             \
  ROW(kFullCharge, 29, "full_charge", kGoesOn, "full charge due: charging, or no discharge",       \
      "none; ends at 99.5 %", "until the SoC is at 99.5 %")                                        \
  ROW(kStudent, 14, "student", kGoesOn, "the student's action", "none", "")                        \
  ROW(kStandIn, 40, "stand_in", kGoesOn,                                                           \
      "the student's action at an estimate of the price: the newest is older than "                \
      "`price_age_s_max`, within `stand_in_s_max`",                                                \
      "as `price_age`",                                                                            \
      "until a price is at most {price_age_s_max} s old, or for at most {stand_in_s_max} s "       \
      "beyond that")

enum class Reason : std::uint8_t {
#define BESS_ROW(enumerator, ...) enumerator,
  BESS_REASONS(BESS_ROW)
#undef BESS_ROW
};

/// Effect of a reason on the battery.
enum class ReasonEffect : std::uint8_t {
  kRests,     ///< must not be driven: 0 W for a while, then released
  kReleases,  ///< not even 0 W: off-grid the house would lose its supply, and a battery
              ///< that does not follow its orders would not follow this one either
  kGoesOn     ///< is driven; the reason explains the order
};

struct ReasonInfo {
  std::int64_t code;
  std::string_view name;
  ReasonEffect effect;
  const char* meaning;
  const char* look_at;
  std::string_view ends;  ///< empty: another decision
};

inline constexpr ReasonInfo kReasons[] = {
#define BESS_ROW(enumerator, code, name, effect, meaning, look_at, ends) \
  {code, name, ReasonEffect::effect, meaning, look_at, ends},
    BESS_REASONS(BESS_ROW)
#undef BESS_ROW
};

inline constexpr int kReasonCount = static_cast<int>(std::size(kReasons));

constexpr const ReasonInfo& info_of(Reason reason) { return kReasons[static_cast<int>(reason)]; }
constexpr std::string_view reason_name(Reason reason) { return info_of(reason).name; }
constexpr bool is_stop_reason(Reason reason) {
  return info_of(reason).effect != ReasonEffect::kGoesOn;
}
constexpr bool must_release(Reason reason) {
  return info_of(reason).effect == ReasonEffect::kReleases;
}

/// Codes are contiguous and unique; stop reasons take precedence.
constexpr bool reasons_are_in_order() {
  bool is_used[kReasonCount] = {};
  bool goes_on = false;
  for (const ReasonInfo& reason : kReasons) {
    if (reason.code < 0 || reason.code >= kReasonCount || is_used[reason.code]) return false;
    is_used[reason.code] = true;
    if (goes_on && reason.effect != ReasonEffect::kGoesOn) return false;
    goes_on = reason.effect == ReasonEffect::kGoesOn;
  }
  return true;
}
static_assert(reasons_are_in_order());

}  // namespace bess
