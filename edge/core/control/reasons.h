// Why a cycle ordered what it did, in one table. A row is a reason; their order is precedence,
// lower ones win. A row has
//   enumerator, code on disk, name in log and status, what it does to the battery, what it means,
//   what to look at, what ends it, with {values} that edge/records/why/what_ends.cpp knows
// A code is never used for another reason: what was logged a year ago must keep its meaning. A new
// row takes the next. shared/manual/guides/troubleshooting.md has the table for people, held by
// tests/unit/edge/core/control/reasons_test.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace bess {

#define BESS_REASONS(ROW)                                                                          \
  ROW(kStopRequested, 0, "stop_requested", kRests, "SIGTERM, or `--cycles` are done: released",    \
      "who stopped it: `journalctl -u bess-edge`", "until a bess-edge is started again")           \
  ROW(kHandOver, 15, "hand_over", kRests, "SIGHUP: the order stays in force",                      \
      "who stopped it: `journalctl -u bess-edge`", "until a bess-edge is started again")           \
  ROW(kClock, 1, "clock", kRests, "NTP has not set the machine's clock",                           \
      "`timedatectl`: an NTP service that runs and reaches its server",                            \
      "until NTP has set this machine's clock")                                                    \
  ROW(kLink, 2, "link", kRests, "the battery was not read",                                        \
      "`battery=` of that line; cable, address, unit; a second Modbus client",                     \
      "until the battery can be read")                                                             \
  ROW(kAlarm, 3, "alarm", kRests, "the battery or its inverter reports a fault",                   \
      "its own display; the map's `alarms`. What only warns stops nothing: `status` and "          \
      "`bess_battery_warning` tell it",                                                            \
      "until the battery's own alarm is gone")                                                     \
  ROW(kTemperature, 4, "temperature", kRests,                                                      \
      "outside `temperature_min_c` to `temperature_max_c`", "the battery's room",                  \
      "until all of it is between {temperature_min_c} and {temperature_max_c} °C")                 \
  ROW(kOffGrid, 5, "off_grid", kReleases,                                                          \
      "the battery feeds an island: released at once, so that the house keeps it",                 \
      "the grid; nothing to mend here", "until the battery is back on the grid")                   \
  ROW(kGridUnknown, 41, "grid_unknown", kReleases,                                                 \
      "the reading that tells whether the grid is there did not come: released at once, as if "    \
      "off-grid",                                                                                  \
      "`status` names the register; gateway, cable, the device's own display",                     \
      "until that register can be read")                                                           \
  ROW(kProtectionLost, 42, "protection_lost", kRests,                                              \
      "an alarm, limit or temperature that was there before could not be read: it may be "         \
      "active",                                                                                    \
      "`status` names the register; gateway, cable, the device's own display; after a change "     \
      "of the device `bess-edge commission`",                                                      \
      "until that register can be read")                                                           \
  ROW(kWrongDirection, 16, "wrong_direction", kReleases, "trip: the power went against the order", \
      "meter, sign, map; `bess-edge commission` again, then `bess-edge clear --yes`",              \
      "until a person has looked and says `bess-edge clear --yes`")                                \
  ROW(kUncontrolledPower, 19, "uncontrolled_power", kReleases,                                     \
      "trip: more power than ordered, or power at 0 W",                                            \
      "what else drives the battery; `power_w`, the map's scale; then `clear`",                    \
      "until a person has looked and says `bess-edge clear --yes`")                                \
  ROW(kSocMismatch, 20, "soc_mismatch", kReleases,                                                 \
      "trip: the SoC stands still or runs apart from the measured power",                          \
      "frozen values, capacity, the power's meter; then `clear`",                                  \
      "until a person has looked and says `bess-edge clear --yes`")                                \
  ROW(kStateLost, 39, "state_lost", kReleases,                                                     \
      "trip: nobody can know whether an earlier run has tripped",                                  \
      "the disk under `[state] folder`; then `clear`",                                             \
      "until a person has looked and says `bess-edge clear --yes`")                                \
  ROW(kOtherMaster, 21, "other_master", kReleases,                                                 \
      "somebody else replaced orders: two running, every other or every third; released, "         \
      "tried again",                                                                               \
      "a second controller, the maker's app, a schedule in the device; `on_other_master`",         \
      "tried again after 10 minutes, then 20, up to 6 hours, until it works")                      \
  ROW(kOrdersFail, 22, "orders_fail", kReleases,                                                   \
      "three orders in a row failed although the battery was read, or it cannot be read "          \
      "while it follows one; tried again",                                                         \
      "`battery=` of those lines; external control switched off on the device",                    \
      "tried again after 10 minutes, then 20, up to 6 hours, until it works")                      \
  ROW(kNoAnswer, 23, "no_answer", kReleases,                                                       \
      "no power flows at mid charge although it was ordered, or orders end before their "          \
      "time (two running, every other or every third); tried again",                               \
      "standby, a blocked battery, acknowledged orders that do nothing; somebody who "             \
      "writes no more than stop",                                                                  \
      "tried again after 10 minutes, then 20, up to 6 hours, until it works")                      \
  ROW(kBatteryCare, 37, "battery_care", kReleases,                                                 \
      "it charges by itself below 12 %, or balances above 95 %: released, tried again "            \
      "after 10 min; a trip (uncontrolled_power) if it goes on for a day",                         \
      "nothing; its own display if it comes back every day",                                       \
      "tried again after 10 minutes, then 20, up to 6 hours, until it works")                      \
  ROW(kCapacity, 24, "capacity", kReleases,                                                        \
      "another capacity than configured; `battery=` may say implausible: the identity "            \
      "checks see it too",                                                                         \
      "is it the right battery; `capacity_wh`",                                                    \
      "until it reports the capacity that is configured")                                          \
  ROW(kSocJump, 25, "soc_jump", kRests,                                                            \
      "the SoC changed by more than power explains; 0 W until three readings agree",               \
      "the battery's display", "until three readings of the SoC agree")                            \
  ROW(kNoPrice, 6, "no_price", kRests, "no price yet",                                             \
      "`prices=` of that line, table below; `--check`",                                            \
      "until there is a price that is at most {price_age_s_max} s old")                            \
  ROW(kPriceAge, 7, "price_age", kRests, "the newest price is older than `price_age_s_max`",       \
      "`prices=` of that line, table below; `--check`",                                            \
      "until there is a price that is at most {price_age_s_max} s old")                            \
  ROW(kPriceQuarterHour, 8, "price_qh", kRests,                                                    \
      "the newest price is older than the quarter-hour before this one", "as price_age",           \
      "until there is a price that is at most {price_age_s_max} s old")                            \
  ROW(kFrozenPrice, 36, "frozen_price", kRests,                                                    \
      "the newest price has not moved for `frozen_price_s_max`, under new stamps, or "             \
      "stayed among four values for two and a half times as long",                                 \
      "the source hangs; it ends with the first price that differs, or the fifth value",           \
      "until the price moves")                                                                     \
  ROW(kSocFull, 9, "soc_full", kGoesOn, "at `soc_max`", "nothing",                                 \
      "until the SoC is below {soc_below_full} %")                                                 \
  ROW(kSocEmpty, 10, "soc_empty", kGoesOn, "at `soc_min`", "nothing",                              \
      "until the SoC is above {soc_above_empty} %")                                                \
  ROW(kReserve, 28, "reserve", kGoesOn, "at the `[[reserve]]` of this hour: no discharge",         \
      "nothing",                                                                                   \
      "until the SoC is above {soc_above_reserve} %, or the reserve of another hour is lower")     \
  ROW(kCycleBudget, 17, "cycle_budget", kGoesOn, "`cycles_per_day_max` is used up",                \
      "passes at local midnight", "until local midnight")                                          \
  ROW(kReversalCap, 26, "reversal_cap", kGoesOn,                                                   \
      "one more change between charging and discharging than `reversals_per_hour_max`",            \
      "the prices: honest ones do not do that (\"A source that lies\")",                           \
      "until fewer than {reversals_per_hour_max} changes of direction lie in the last hour")       \
  ROW(kPowerLimit, 11, "power_limit", kGoesOn, "the order was cut to the battery's limit",         \
      "nothing", "as long as the battery itself takes or gives no more")                           \
  ROW(kOutsideLimit, 30, "outside_limit", kGoesOn,                                                 \
      "another program's limit is in force; or has lapsed, or cannot be understood",               \
      "`bess-edge status`; the file of `[limits]`, who writes it",                                 \
      "until the limit from outside lapses or is taken away")                                      \
  ROW(kMeterLost, 31, "meter_lost", kGoesOn, "no reading of the meter for 30 s: 0 W",              \
      "`meter=` of that line; cable, address, unit", "until the meter can be read")                \
  ROW(kMeterMismatch, 38, "meter_mismatch", kGoesOn,                                               \
      "the meter does not step with the battery, so that it is as good as lost: 0 W; after "       \
      "a pause an eighth of the power, to see whether it does again",                              \
      "is it frozen, inverted, late, on another phase, of another ratio; is the battery's "        \
      "own power right; something else that holds the grid at a value: `judged = false`",          \
      "tried again with an eighth of the power at {meter_pause_end}")                              \
  ROW(kImportLimit, 32, "import_limit", kGoesOn,                                                   \
      "the house leaves the battery no more of what the connection may take",                      \
      "nothing; `[meter]`", "as long as the house leaves no more of the connection")               \
  ROW(kExportLimit, 33, "export_limit", kGoesOn,                                                   \
      "the house leaves the battery no more of what the connection may give",                      \
      "nothing; `[meter]`", "as long as the house leaves no more of the connection")               \
  ROW(kQuarterHourPeak, 34, "quarter_hour_peak", kGoesOn,                                          \
      "the quarter-hour's mean would pass `peak_w_max`; discharging: what was taken is "           \
      "given back",                                                                                \
      "nothing; `[meter]`", "until the quarter-hour is over at {quarter_hour_end}")                \
  ROW(kRamp, 18, "ramp", kGoesOn, "the order was cut to `ramp_w_max`", "nothing",                  \
      "{ramp_w_max} W more each cycle")                                                            \
  ROW(kHeld, 27, "held", kGoesOn, "an operator's `bess-edge hold`",                                \
      "`status`: how much, until when",                                                            \
      "until {hold_end}; `bess-edge hold --release` ends it before")                               \
  ROW(kRule, 35, "rule", kGoesOn,                                                                  \
      "a rule of the operator that came with the student (\"Your own rules\" in "                  \
      "`workstation/README.md`)",                                                                  \
      "`--check` lists them", "as long as it holds: {rules}")                                      \
  ROW(kPriceLow, 12, "price_low", kGoesOn,                                                         \
      "at or below `low_price_eur_per_mwh`, and the student said otherwise", "nothing",            \
      "until the price is above {low_price} EUR/MWh")                                              \
  ROW(kPriceHigh, 13, "price_high", kGoesOn,                                                       \
      "at or above `high_price_eur_per_mwh`, and the student said otherwise", "nothing",           \
      "until the price is below {high_price} EUR/MWh")                                             \
  ROW(kFullCharge, 29, "full_charge", kGoesOn,                                                     \
      "a full charge is due: charging, or not discharging", "nothing; it ends at 99.5 %",          \
      "until the SoC is at 99.5 %")                                                                \
  ROW(kStudent, 14, "student", kGoesOn, "the student's action", "nothing", "")                     \
  ROW(kStandIn, 40, "stand_in", kGoesOn,                                                           \
      "the student's action, at what the newest price has probably become: it is older than "      \
      "`price_age_s_max`, and `stand_in_s_max` lets it",                                           \
      "as price_age",                                                                              \
      "until there is a price that is at most {price_age_s_max} s old, or for at most "            \
      "{stand_in_s_max} s beyond that")

enum class Reason : std::uint8_t {
#define BESS_ROW(enumerator, ...) enumerator,
  BESS_REASONS(BESS_ROW)
#undef BESS_ROW
};

/// What a reason makes of the battery.
enum class ReasonEffect : std::uint8_t {
  kRests,     ///< it must not be driven: 0 W, held, then released
  kReleases,  ///< nor held: a house that lives on its battery goes dark, and a battery that does
              ///< not follow its orders need not follow this one either
  kGoesOn     ///< it is driven; the reason is what the order is as it is
};

struct ReasonInfo {
  std::int64_t code;
  std::string_view name;
  ReasonEffect effect;
  const char* meaning;
  const char* look_at;
  std::string_view ends;  ///< empty: nothing but another decision
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
constexpr bool is_better_released(Reason reason) {
  return info_of(reason).effect == ReasonEffect::kReleases;
}

/// Codes without a gap, each once; and what stops the battery wins over what does not.
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
