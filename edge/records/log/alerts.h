// Alerts, one row each: enumerator, code, meaning, remedy. `status`, the page and bess-notify show
// them as "WARN code: what was found; remedy". A code identifies an alert in --json and to the
// operator's command, so it does not change when the wording does.
// shared/manual/guides/troubleshooting.md has the same table, checked by health_test.cpp.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace bess {

#define BESS_ALERTS(ROW)                                                                           \
  ROW(kNoController, "no_controller", "no controller runs with this configuration",                \
      "start it: `systemctl start bess-edge`")                                                     \
  ROW(kUnknown, "unknown", "a process holds the lock, but publishes no status",                    \
      "check whether the disk is full or read-only")                                               \
  ROW(kStarting, "starting", "the first control cycle is not complete", "wait for it")             \
  ROW(kOverdue, "overdue", "no control cycle for twice its period; CRITICAL after four times",     \
      "see `journalctl -u bess-edge`")                                                             \
  ROW(kTripped, "tripped", "not driving until a person clears the trip",                           \
      "check the cause (`bess-edge why`, `bess-edge log`), then `bess-edge clear --yes`")          \
  ROW(kBattery, "battery", "the battery could not be read, or an order not be written",            \
      "check cable, address and unit id")                                                          \
  ROW(kPrices, "prices", "no usable price arrived",                                                \
      "check network and `[price] url`: `bess-prices --check`")                                    \
  ROW(kPointLost, "point_lost", "one register could not be read",                                  \
      "check the gateway and the device's own display")                                            \
  ROW(kPointClamped, "point_clamped", "a value is out of range and was clamped",                   \
      "check `min` and `max` of this point in the map")                                            \
  ROW(kBatteryWarning, "battery_warning",                                                          \
      "the battery reports a warning, which does not stop control", "check its own display")       \
  ROW(kNoPower, "no_power", "no power after several orders",                                       \
      "check whether the battery is full, empty, cold or in standby")                              \
  ROW(kLowPower, "low_power", "less power than ordered in several readings",                       \
      "check `power_w`, the battery's own limits, and whether a module is off")                    \
  ROW(kEnergyMismatch, "energy_mismatch", "SoC change and measured energy differ",                 \
      "check `capacity_wh` and the measured power")                                                \
  ROW(kSetPointIgnored, "set_point_ignored",                                                       \
      "energy flowed against or beyond orders (trip at 20 % of the capacity)",                     \
      "look for another controller; check the wiring")                                             \
  ROW(kUnexplainedPower, "unexplained_power", "power at 0 W or in addition to orders",             \
      "look for other loads and controllers")                                                      \
  ROW(kOwnLimits, "own_limits", "the battery's own limits allow no power for an hour",             \
      "check its own display")                                                                     \
  ROW(kSlowResponse, "slow_response", "the battery is slower than its map",                        \
      "run `bess-edge commission`: it measures lag and ramp, and prints the settings")             \
  ROW(kLostOrders, "lost_orders", "orders were replaced or ended early",                           \
      "look for another controller: the manufacturer's app, a schedule in the device")             \
  ROW(kPriceStep, "price_step", "a price step of more than 2300 EUR/MWh waits for the next row",   \
      "no action: the next row decides")                                                           \
  ROW(kFrozenPrice, "frozen_price",                                                                \
      "price unchanged for 30 minutes with new time stamps, or only four values for hours",        \
      "compare with the source")                                                                   \
  ROW(kUnusualPrice, "unusual_price", "price beyond 15000 EUR/MWh: rare, accepted",                \
      "compare with the source")                                                                   \
  ROW(kNoDayAhead, "no_day_ahead",                                                                 \
      "no day-ahead price for more than a day: planning with typical prices earns less",           \
      "check `[outlook]` with `bess-prices --check`")                                              \
  ROW(kHoldFile, "hold_file", "hold file unreadable, hold ignored", "repeat `bess-edge hold`")     \
  ROW(kMeter, "meter", "meter could not be read", "check cable, and address and map of `[meter]`") \
  ROW(kMeterMismatch, "meter_mismatch",                                                            \
      "the meter does not respond to battery steps and is ignored",                                \
      "check whether the meter is frozen, inverted, on another phase or has another ratio; "       \
      "check the battery's measured power")                                                        \
  ROW(kHousePower, "house_power", "the power of the house is implausible",                         \
      "check signs, phase and position of the meter, and `[meter] pv_w_max`")                      \
  ROW(kLimitExpired, "limit_expired", "external limit expired or never set: 0 W",                  \
      "check the program that writes limits, or use `bess-edge limit`")                            \
  ROW(kLimitFile, "limit_file", "`[limits] file` unreadable or malformed: 0 W",                    \
      "check its format and owner")                                                                \
  ROW(kUpdate, "update", "an upgrade was refused, reverted or failed",                             \
      "see `sudo bess-probation history`; the next upgrade, or `sudo bess-probation allow "        \
      "VERSION`, ends this alert")                                                                 \
  ROW(kDiskSlow, "disk_slow", "log records dropped: disk too slow",                                \
      "check the disk (`dmesg`); replace it if this recurs")                                       \
  ROW(kRunFolder, "run_folder", "files of `[state] run_folder` cannot be written",                 \
      "check its permissions")                                                                     \
  ROW(kStatusBehind, "status_behind", "the status is older than the log",                          \
      "check whether the disk is full or read-only")                                               \
  ROW(kLogUnwritable, "log_unwritable",                                                            \
      "files of `[state]`, `[log]` or `[metrics]` cannot be written, which does not stop "         \
      "control",                                                                                   \
      "check whether the disk is full or read-only, and the permissions of these folders")         \
  ROW(kDiskFull, "disk_full", "the disk of `[state] folder` is full or read-only",                 \
      "free space or remount it")                                                                  \
  ROW(kStorageLife, "storage_life", "storage has used most of its life", "replace it soon")        \
  ROW(kStorageSpare, "storage_spare",                                                              \
      "storage has used 80 % of its spare blocks; CRITICAL at 90 %", "replace it now")             \
  ROW(kFileSystem, "file_system", "the kernel has counted errors in the state folder",             \
      "check the storage: `dmesg`")                                                                \
  ROW(kNoStatus, "no_status", "bess-notify gets no status", "run `bess-edge status`")              \
  ROW(kNotifyState, "notify_state", "bess-notify cannot keep its state; alerts may come twice",    \
      "check `[notify] folder`")                                                                   \
  ROW(kSettledPrices, "settled_prices", "settled prices are four days late",                       \
      "`bess-prices --settle` shows the cause")                                                    \
  ROW(kMqttCutOff, "mqtt_cut_off", "the MQTT broker ends each connection",                         \
      "look for another client with the same id, such as a copied machine")

enum class Alert : std::uint8_t {
#define BESS_ROW(enumerator, ...) enumerator,
  BESS_ALERTS(BESS_ROW)
#undef BESS_ROW
};

struct AlertInfo {
  std::string_view code;
  const char* meaning;
  const char* remedy;
};

inline constexpr AlertInfo kAlerts[] = {
#define BESS_ROW(enumerator, code, meaning, remedy) {code, meaning, remedy},
    BESS_ALERTS(BESS_ROW)
#undef BESS_ROW
};

constexpr const AlertInfo& info_of(Alert alert) { return kAlerts[static_cast<int>(alert)]; }

inline std::string alert_line(std::string_view code, const std::string& found, const char* remedy,
                              bool is_critical = false) {
  std::string line = is_critical ? "CRITICAL " : "WARN ";
  return line.append(code).append(": ").append(found).append("; ").append(remedy);
}

/// `found`: with numbers and times; empty = the meaning.
inline std::string alert_line(Alert alert, const std::string& found = "",
                              bool is_critical = false) {
  const AlertInfo& info = info_of(alert);
  return alert_line(info.code, found.empty() ? info.meaning : found, info.remedy, is_critical);
}

}  // namespace bess
