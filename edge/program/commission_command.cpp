#include "edge/program/commission_command.h"

#include <algorithm>
#include <cstdio>

#include "edge/battery/commission.h"
#include "edge/log/journal.h"
#include "edge/program/commission_file.h"
#include "edge/program/startup.h"

namespace bess {
namespace {

CommissionSettings settings_of(const EdgeConfig& config) {
  const GuardSettings& guard = config.control.guard;
  CommissionSettings settings;
  const Commissioning& test = config.map.commissioning;
  settings.power_w = std::min(test.power_w, guard.power_w);
  settings.rest_s = test.settle_s;
  settings.drive_s = test.duration_s;
  settings.tolerance_percent = test.tolerance_percent;
  settings.soc_min_e4 = guard.soc_min_e4;
  settings.soc_max_e4 = guard.soc_max_e4;
  settings.order_duration_s = config.control.order_duration_s;
  return settings;
}

int ask_for_yes(const EdgeConfig& config, const CommissionSettings& settings) {
  report(JournalLevel::kError,
         "commission orders the battery at %s to rest for %d s, then to charge or discharge %d W "
         "for %d s, then releases it; add --yes to do that",
         battery_place(config).c_str(), settings.rest_s, settings.power_w, settings.drive_s);
  return 2;
}

void complain_about_release(const EdgeConfig& config, const CommissionResult& result) {
  char timer[64] = "; it has no timer of its own: set it back by hand";
  if (config.control.has_watchdog) {
    std::snprintf(timer, sizeof timer, "; its own timer ends that after %d s",
                  config.control.order_duration_s);
  }
  report(JournalLevel::kError,
         "commission %s: the battery could not be released (%s) and may still follow an order of "
         "%d W%s",
         battery_place(config).c_str(), status_text(result.release_status).data(),
         result.ordered_power_w, timer);
}

}  // namespace

int run_commission_command(const CommandLine& command_line, const EdgeConfig& config,
                           ModbusBattery& battery, EdgeClock& clock) {
  const CommissionSettings settings = settings_of(config);
  if (!command_line.yes) return ask_for_yes(config, settings);
  if (!reach_battery(config, battery, clock)) return 1;
  std::printf("commission %s: resting %d s, then %d W for %d s ...\n",
              battery_place(config).c_str(), settings.rest_s, settings.power_w, settings.drive_s);
  std::fflush(stdout);
  const CommissionResult result =
      SignCheck<ModbusBattery, EdgeClock>(settings, battery, clock).run();
  if (result.release_status != Status::kOk) complain_about_release(config, result);
  if (result.verdict != CommissionVerdict::kPassed) {
    const bool is_link = result.verdict == CommissionVerdict::kNoLink;
    report(JournalLevel::kError, "commission %s: ordered %d W, measured %d W: %s%s%s",
           battery_place(config).c_str(), result.ordered_power_w, result.measured_power_w,
           commission_text(result.verdict).data(), is_link ? ": " : "",
           is_link ? status_text(result.status).data() : "");
    return 1;
  }
  std::string error;
  const std::int64_t utc_s = clock.now_utc_ns() / kNanosecondsPerSecond;
  if (!write_commission_file(config, result, utc_s, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  std::printf("passed     ordered %d W, measured %d W: the sign is right; stored in %s\n",
              result.ordered_power_w, result.measured_power_w, config.state.folder.c_str());
  return 0;
}

}  // namespace bess
