// Sign check on the real battery, with its result stored: `bess-edge commission`.
#include <algorithm>
#include <cstdio>

#include "edge/app/commands/command.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/program/startup.h"
#include "edge/app/recording/exchange_recorder.h"
#include "edge/app/storage/commission_file.h"
#include "edge/app/storage/operator_files.h"
#include "edge/core/site/meter_check.h"
#include "edge/device/battery/commission.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/records/log/journal.h"
#include "shared/host/text.h"

namespace bess {
namespace {

struct CommissionOptions {
  bool yes = false;
  std::string record_path;
};

constexpr const char* kCommissionFooter =
    R"(Orders 0 W for 10 s, then charges and discharges 500 W for 30 s each; [commissioning] of the
map can set other values. In each direction the measured power must follow the set point within
[response] of the map, and so must the meter of [meter]. Then, if SoC, limits and connection allow,
the battery follows half the largest step of the controller for some seconds in each direction: a
lag is independent of the step, a ramp is not. A battery whose largest step certainly takes longer
than settle_s is refused, with the lines to set; an uncertain result is a warning with its values. A
direction without room in the SoC is reported and not tested. At the end the battery is released.
The result is stored in the [state] folder and is valid for this map, variant and address. bess-edge
controls no battery without it.
Exit codes:
  0 passed
  1 refused, with the cause
  2 command line error, or --yes missing
Examples:
  bess-edge commission --config /etc/bess/edge.toml --yes
  bess-edge commission --record steps.jsonl --yes)";

/// Meter of [meter]: a separate device or the battery's grid power point.
class SiteMeter {
 public:
  SiteMeter(const SiteSettings& settings, ModbusMeter& meter)
      : settings_(settings), meter_(meter) {}
  [[nodiscard]] bool exists() const {
    return settings_.meter != MeterSource::kNone && settings_.meter_check.judges;
  }
  Status read(const BatteryMeasurement& m, std::int32_t& grid_power_w) {
    if (settings_.meter == MeterSource::kMap) return meter_.read(grid_power_w);
    grid_power_w = m.grid_power_w;
    return m.has_grid_power ? Status::kOk : Status::kImplausible;
  }

 private:
  const SiteSettings& settings_;
  ModbusMeter& meter_;
};

/// False under an external limit, or if the connection is limited and the house unmetered: then no
/// more than the power of the sign test is ordered.
bool may_drive_further(const SiteConfig& site, std::int64_t utc_s) {
  const ConnectionSettings& connection = site.settings.connection;
  const bool is_seen =
      site.settings.meter != MeterSource::kNone && site.settings.meter_check.judges;
  const std::int32_t narrowest_w =
      std::min({connection.import_w_max, connection.export_w_max, connection.peak_w_max});
  if (narrowest_w < kAnyPowerW && !is_seen) return false;
  if (!site.settings.has_outside_limits) return true;
  OutsideLimit limit;
  bool is_set = false;
  const Status status = LimitFile{site.limit_file.c_str()}.read(limit, is_set);
  return status == Status::kOk && !(is_set && utc_s < limit.until_utc_s);
}

CommissionSettings settings_of(const EdgeConfig& config) {
  const GuardSettings& guard = config.control.guard;
  CommissionSettings settings;
  const Commissioning& test = config.battery.map.commissioning;
  settings.power_w = std::min(test.power_w, guard.power_w);
  settings.rest_s = test.settle_s;
  settings.drive_s = test.duration_s;
  settings.tolerance_percent = test.tolerance_percent;
  const Watchdog& watchdog = config.battery.map.watchdog;
  const bool lasts_a_step =
      watchdog.kind != Watchdog::Kind::kNone && watchdog.refresh_s >= kSecondsPerStep;
  settings.unfed_s = lasts_a_step ? kSecondsPerStep + 5 : 0;
  settings.response = config.battery.map.response;
  const ConnectionSettings& connection = config.site.settings.connection;
  settings.import_w_max =
      std::min(connection.import_w_max, connection.peak_w_max) - connection.margin_w;
  settings.export_w_max = connection.export_w_max - connection.margin_w;
  settings.rated_w = guard.power_w;
  settings.step_w_max =
      guard.ramp_w_max > 0 ? std::min(guard.ramp_w_max, 2 * guard.power_w) : 2 * guard.power_w;
  settings.soc_min_e4 = guard.soc_min_e4;
  settings.soc_max_e4 = guard.soc_max_e4;
  settings.order_duration_s = config.control.order_duration_s;
  return settings;
}

std::int32_t further_w(const CommissionSettings& settings) {
  return settings.drives_further ? std::min(settings.rated_w, settings.step_w_max)
                                 : settings.power_w;
}

int ask_for_yes(const EdgeConfig& config, const CommissionSettings& settings) {
  report(
      JournalLevel::kError,
      "commission orders the battery at %s to stay at 0 W for %d s, then to charge and discharge "
      "%d W for %d s each, then, if SoC and limits allow, up to %d W for some seconds, then "
      "releases it: repeat with --yes",
      battery_place(config.battery).c_str(), settings.rest_s, settings.power_w, settings.drive_s,
      further_w(settings));
  return 2;
}

void complain_about_release(const EdgeConfig& config, const CommissionResult& result) {
  const std::string timer =
      config.control.has_watchdog
          ? formatted("; its dead-man timer ends it after %d s", config.control.order_duration_s)
          : "; it has no dead-man timer: reset it by hand";
  report(JournalLevel::kError,
         "commission %s: the battery was not released (%s) and may still follow %d W%s",
         battery_place(config.battery).c_str(), status_text(result.release_status).data(),
         result.ordered_power_w, timer.c_str());
}

/// Doubts are reported with their values and cause no refusal.
void print_speed(const DirectionResult& direction, const EdgeConfig& config) {
  const StepResponseResult& speed = direction.speed;
  if (speed.largest.most <= 0) return;  // refused before this test
  const std::int32_t step_w = settings_of(config).step_w_max;
  const char* const indent = "           ";
  std::printf("%sfits a lag of %.1f s, a time constant of %.1f s and ", indent,
              speed.dynamics.dead_time_s, speed.dynamics.time_constant_s);
  const std::int32_t ramp = ramp_w_per_s(speed);
  ramp > 0 ? std::printf("a ramp of %d W/s", ramp) : std::printf("no ramp");
  std::printf(": a step of %d W takes %.1f s (%.1f to %.1f s)\n", step_w, speed.largest.best,
              speed.largest.least, speed.largest.most);
  if (direction.is_held_back) {
    std::printf("%swarning: %d W ordered, only %d W measured: check the battery's own limits\n",
                indent, direction.further_w, direction.further_measured_w);
  }
  if (!speed.is_doubtful) return;
  std::printf("%swarning: settle_s = %d may be too short%s\n", indent,
              config.battery.map.response.settle_s,
              speed.has_two ? "" : ": repeat at a medium SoC, which allows a larger step");
}

void print_direction(const char* name, const DirectionResult& direction, std::int32_t soc_e4,
                     const EdgeConfig& config) {
  if (!direction.is_tested) {
    std::printf(
        "%-10s not tested: SoC %.1f %% or the battery's own limits leave no room; only the other "
        "direction is known\n",
        name, soc_e4 / 100.0);
    return;
  }
  std::printf("%-10s ordered %d W, measured %d W", name, direction.ordered_power_w,
              direction.measured_power_w);
  if (direction.came_ms >= 0)
    std::printf(", reached within %.1f s", static_cast<double>(direction.came_ms) / 1e3);
  std::printf("\n");
  print_speed(direction, config);
}

void print_measured(const EdgeConfig& config, const CommissionResult& result) {
  if (result.charge.is_tested || result.discharge.is_tested) {
    print_direction("charge", result.charge, result.soc_e4, config);
    print_direction("discharge", result.discharge, result.soc_e4, config);
  }
  if (result.meter == MeterVerdict::kNotAsked) return;
  std::printf("meter      %d %% of the battery's steps; house %d W with the battery at 0 W%s\n",
              result.meter_percent, result.rest_house_w,
              is_plausible_house(result.rest_house_w, 0, config.site.settings.pv_w_max)
                  ? ""
                  : ", which is negative: check its sign; with solar panels, set [meter] pv_w_max");
}

/// Settings with which the check would pass.
void print_proposal(const EdgeConfig& config, const CommissionResult& result) {
  if (result.wanted_duration_s > 0) {
    std::printf("[watchdog]   # of the map, %s\nduration_s = %d   # now %d\nrefresh_s = %d\n",
                config.battery.map_path.c_str(), result.wanted_duration_s,
                config.battery.map.watchdog.duration_s, result.wanted_duration_s / 2);
  }
  if (result.wanted_settle_s > 0 || result.wanted_tolerance_w > 0) {
    std::printf("[response]   # of the map, %s\n", config.battery.map_path.c_str());
  }
  if (result.wanted_settle_s > 0) {
    std::printf("settle_s = %d   # now %d\n", result.wanted_settle_s,
                config.battery.map.response.settle_s);
  }
  if (result.wanted_tolerance_w > 0) {
    std::printf("tolerance_w = %d   # now %d\n", result.wanted_tolerance_w,
                config.battery.map.response.tolerance_w);
  }
  if (result.wanted_ramp_w_max > 0) {
    std::printf(
        "[guard]      # of the configuration: a larger step exceeds settle_s\n"
        "ramp_w_max = %d\n",
        result.wanted_ramp_w_max);
  }
}

int refuse(const EdgeConfig& config, ModbusBattery& battery, const CommissionResult& result) {
  std::string read;
  if (result.verdict == CommissionVerdict::kMeterLost) {
    read = status_text(result.status);
  } else if (result.verdict == CommissionVerdict::kNoLink) {
    read = reading_text(config, battery, result.status, result.lost_point);
  } else {
    read = "read: " + measured_text(config.battery.map, battery.live());
  }
  report(JournalLevel::kError, "commission %s: ordered %d W, measured %d W: %s; %s",
         battery_place(config.battery).c_str(), result.ordered_power_w, result.measured_power_w,
         commission_text(result.verdict).data(), read.c_str());
  print_proposal(config, result);
  return 1;
}

int run_commission(const CommissionOptions& options, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  DeviceSession session;
  if (!session.begin(config)) return 1;
  EdgeClock& clock = *session.clock;
  CommissionSettings test = settings_of(config);
  test.drives_further = may_drive_further(config.site, utc_seconds(clock));
  if (!options.yes) return ask_for_yes(config, test);
  static ModbusBattery battery(config.battery.link, config.battery.map,
                               config.clock);  // outlives a failed check
  static ExchangeRecorder recorder;            // outlives its listener
  FileMessage message;
  if (!options.record_path.empty()) {
    if (!recorder.start(options.record_path.c_str(),
                        recording_head_of(config.battery.map, config.battery.link, config.clock),
                        config.battery.map, config.clock, message)) {
      return failed(message.c_str());
    }
    battery.link().set_exchange_listener(recorder.listener());
  }
  ModbusMeter meter(config.site.link, config.site.map, config.clock);
  release_if_a_check_fails(battery);
  if (!reach_battery(config, battery, clock)) return 1;
  std::printf(
      "commission %s: 0 W for %d s, then %d W for %d s in each direction, then up to %d W for some "
      "seconds ...\n",
      battery_place(config.battery).c_str(), test.rest_s, test.power_w, test.drive_s,
      further_w(test));
  std::fflush(stdout);
  CommissionResult result = SignCheck<ModbusBattery, EdgeClock, SiteMeter>(
                                test, battery, clock, SiteMeter(config.site.settings, meter))
                                .run();
  battery.link().set_exchange_listener({});
  if (!recorder.finish(message)) report(JournalLevel::kError, "%s", message.c_str());
  if (result.release_status != Status::kOk) complain_about_release(config, result);
  print_measured(config, result);
  std::fflush(stdout);
  if (result.verdict != CommissionVerdict::kPassed) return refuse(config, battery, result);
  for (const std::int8_t point : config.battery.map.measure) {
    if (battery.has_optional(point)) result.present.push_back(point);
  }
  std::string error;
  const std::int64_t utc_s = utc_seconds(clock);
  if (!write_commission_file(config, result, utc_s, error)) return failed(error);
  std::printf("passed     ordered %d W, measured %d W: the sign is right; stored in %s\n",
              result.ordered_power_w, result.measured_power_w, config.state.folder.c_str());
  return 0;
}

}  // namespace

void add_commission(EdgeCommand root) {
  EdgeCommand command =
      root.subcommand("commission", "test once that the battery follows the sign of set points");
  const auto options = std::make_shared<CommissionOptions>();
  command
      .option("--record", options->record_path,
              "record Modbus exchanges to FILE, for map check --steps")
      .value_name("FILE");
  command.flag("--yes", options->yes, "send the orders; default: only list them");
  command.footer(kCommissionFooter);
  command.set_action(
      [options](SettingsFile& settings) { return run_commission(*options, settings); });
}

}  // namespace bess
