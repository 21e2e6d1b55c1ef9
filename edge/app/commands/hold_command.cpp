// Operator's order with an end time, written to a file for the controller: `bess-edge hold`.
#include <unistd.h>

#include <cerrno>
#include <cmath>
#include <cstdio>
#include <optional>

#include "edge/app/commands/command.h"
#include "edge/app/storage/instance_lock.h"
#include "edge/app/storage/operator_files.h"
#include "edge/app/storage/restored_state.h"
#include "edge/core/control/hold.h"
#include "edge/core/control/tick.h"
#include "edge/records/log/atomic_file.h"
#include "edge/records/log/journal.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/text.h"
#include "shared/local_time.h"

namespace bess {
namespace {

struct HoldOptions {
  std::optional<std::int64_t> power_w;
  bool release = false;
  std::int64_t for_s = 0;  ///< 0 = not given
};

constexpr const char* kHoldFooter =
    R"(The controller follows the hold from its next control cycle until the end time, also over
restarts, and then trades again. A hold replaces student and price thresholds and needs no price.
All other rules override it: stop reasons, SoC bounds, reserve, full cycles, reversals, power and
connection limits, ramp. During a trip no hold is followed: see bess-edge clear. A new hold replaces
the previous one. The hold is a file in the [state] folder: run this command as the controller's
user or as root.
Exit codes:
  0 done
  1 refused, with the cause
  2 command line error
Examples:
  bess-edge hold 0 --for 30m
  bess-edge hold -2kW --for 2h
  bess-edge hold --release)";

/// Parses whole watts: 2000, 2000W or 2kW. Returns the error, or an empty text.
std::string take_power(std::string_view text, std::optional<std::int64_t>& power_w) {
  constexpr double kLargest = 1e9;
  std::string_view digits = text;
  if (digits.starts_with('+')) digits.remove_prefix(1);
  if (digits.ends_with('W')) digits.remove_suffix(1);
  const bool is_kilo = digits.ends_with('k');
  if (is_kilo) digits.remove_suffix(1);
  double number = 0;
  const bool is_number = read_number(digits, number);
  const double watts = is_kilo ? 1e3 * number : number;
  const bool is_whole = std::abs(watts) <= kLargest && watts == std::nearbyint(watts);
  if (!is_number || !is_whole) {
    return "must be a whole number of watts such as 2000, 2000W or -2kW, not " + std::string(text);
  }
  power_w = static_cast<std::int64_t>(watts);
  return "";
}

/// No set point while tripped, regardless of the source.
void print_trip(const EdgeConfig& config) {
  LogReader log;
  FileMessage ignored;
  if (!log.open(config.log, ignored)) return;
  const std::optional<Trip> trip =
      standing_trip(log.ring(), log.run_ring(), state_file_paths(config, kClearedFileName));
  if (!trip) return;
  std::printf(
      "           NOT FOLLOWED: tripped, %s at %s, until cleared with bess-edge clear --yes (check "
      "the cause: bess-edge log --last 10)\n",
      reason_name(trip->reason).data(), local_text(trip->utc_s).c_str());
}

void print_controller(const EdgeConfig& config) {
  if (!is_controller_running(config)) {
    std::printf(
        "           no controller runs with this configuration: systemctl start bess-edge\n");
  } else if (!config.control.control) {
    std::printf("           control = false: the controller only logs this order\n");
  }
}

void print_hold(const EdgeConfig& config, const Hold& hold, std::int64_t now_utc_s) {
  const char* const direction = hold.power_w > 0   ? " (charging)"
                                : hold.power_w < 0 ? " (discharging)"
                                                   : " (idle)";
  std::printf("hold       %d W%s until %s local time\n", hold.power_w, direction,
              local_text(hold.until_utc_s).c_str());
  std::printf(
      "           from the control cycle at %s, at any price; stop reasons, SoC bounds, reserve, "
      "limits and ramp override it\n",
      local_clock_text(next_tick_utc_s(now_utc_s)).c_str());
  print_controller(config);
  print_trip(config);
}

bool is_kept(const char* path, const Hold& hold) {
  return replace_file_durably(path, format_hold(hold).view());
}

bool is_gone(const char* path) {
  if (unlink(path) != 0 && errno != ENOENT) return false;
  sync_folder_of(path);
  return true;
}

void warn_of_next_boot(const StateFilePaths& paths, const FileMessage& error) {
  report(JournalLevel::kWarning,
         "%s; stored only in %s, lost at the next boot: then repeat bess-edge hold", error.c_str(),
         paths.run.c_str());
}

/// One copy is enough: the controller follows the newest.
int keep_hold(const EdgeConfig& config, const Hold& hold, std::int64_t now_utc_s) {
  const StateFilePaths paths = state_file_paths(config, kHoldFileName);
  FileMessage error;
  FileMessage run_error;
  const bool in_state = is_kept(paths.state.c_str(), hold) ||
                        fail_with_errno(paths.state.c_str(), "cannot write the hold", error);
  const bool in_run = !paths.run.empty() &&
                      (is_kept(paths.run.c_str(), hold) ||
                       fail_with_errno(paths.run.c_str(), "cannot write the hold", run_error));
  if (!in_state && !in_run) {
    return failed(std::string(error.view()) + "; the hold is unchanged");
  }
  if (!in_state) warn_of_next_boot(paths, error);
  if (!run_error.empty()) report(JournalLevel::kWarning, "note: %s", run_error.c_str());
  print_hold(config, hold, now_utc_s);
  return 0;
}

/// If one copy cannot be deleted, an expired hold in the other folder overrides it.
int release_hold(const EdgeConfig& config) {
  constexpr Hold kOver{.power_w = 0, .until_utc_s = 1};
  const StateFilePaths paths = state_file_paths(config, kHoldFileName);
  const bool has_run = !paths.run.empty();
  FileMessage error;
  const bool of_state = is_gone(paths.state.c_str()) ||
                        fail_with_errno(paths.state.c_str(), "cannot delete the hold file", error);
  const bool of_run = !has_run || is_gone(paths.run.c_str()) ||
                      fail_with_errno(paths.run.c_str(), "cannot delete the hold file", error);
  const bool is_outdone = (of_state || (has_run && is_kept(paths.run.c_str(), kOver))) &&
                          (of_run || is_kept(paths.state.c_str(), kOver));
  if (!is_outdone) {
    return failed(std::string(error.view()) + "; the hold is still in force");
  }
  if (!of_state) warn_of_next_boot(paths, error);
  std::printf("hold       none: prices decide from the next control cycle\n");
  return 0;
}

int run_hold(const HoldOptions& options, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  if (options.release) return release_hold(config);
  const std::int64_t power_w_max = config.control.guard.power_w;
  const std::int64_t power_w = *options.power_w;
  if (power_w > power_w_max || power_w < -power_w_max) {
    return failed(formatted("hold %lld W exceeds [battery] power_w of %s: choose -%lld to %lld",
                            static_cast<long long>(power_w), settings.path.c_str(),
                            static_cast<long long>(power_w_max),
                            static_cast<long long>(power_w_max)));
  }
  set_market_time_zone();
  const std::int64_t now_utc_s = utc_seconds(config.clock);
  const Hold hold{.power_w = static_cast<std::int32_t>(power_w),
                  .until_utc_s = static_cast<std::uint32_t>(now_utc_s + options.for_s)};
  for (const FixedText<511>* const folder : {&config.state.folder, &config.state.run_folder}) {
    if (!folder->empty()) make_folder(folder->c_str());  // a failure is reported when writing
  }
  return keep_hold(config, hold, now_utc_s);
}

}  // namespace

void add_hold(EdgeCommand root) {
  EdgeCommand command =
      root.subcommand("hold", "order a constant power until an end time, at any price");
  const auto options = std::make_shared<HoldOptions>();
  command
      .parsed(
          "watts",
          [options](const std::string& text) { return take_power(text, options->power_w); },
          "power, W or kW (2000, 2000W, 2kW): positive charges, negative discharges, 0 is idle; "
          "at most [battery] power_w")
      .value_name("WATTS");
  command.duration("--for", options->for_s, 120, "duration, 2m to 7d, such as 90m or 1d12h");
  command.flag("--release", options->release, "end the hold now")
      .excludes("--for")
      .excludes("watts");
  command.footer(kHoldFooter);
  command.set_action(
      [options](SettingsFile& settings) { return run_hold(*options, settings); },
      [options] {
        const bool is_order = options->power_w.has_value() && options->for_s > 0;
        return std::string(options->release || is_order
                               ? ""
                               : "WATTS and --for DURATION, or --release, is missing");
      });
}

}  // namespace bess
