// Temporary limit of the battery's power, through the file of [limits]: `bess-edge limit`. For
// people and for site controllers that cannot write that file.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "edge/app/commands/command.h"
#include "edge/records/log/atomic_file.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

struct LimitOptions {
  std::string charge_w;  ///< empty = any
  std::string discharge_w;
  bool clear = false;
  std::int64_t for_s = 0;  ///< 0 = not given
};

constexpr const char* kLimitFooter =
    R"(Replaces the file of [limits] by one line, "charge_w discharge_w utc_until". Other programs
can write it too: write a new file, then rename it. The controller reads it every few seconds and
reduces a larger order immediately. After its end time, or --clear, the limit no longer applies;
with on_timeout = "idle" the battery then stays at 0 W until a new limit.
Exit codes:
  0 done
  1 no [limits], or file not writable
  2 command line error
Examples:
  bess-edge limit --charge 0 --for 15m
  bess-edge limit --charge 2000 --discharge 1000 --for 2h
  bess-edge limit --clear)";

int refuse(const std::string& message) { return failed("limit: " + message); }

int clear(const char* path) {
  if (unlink(path) != 0 && errno != ENOENT) {
    return refuse(std::string(path) + ": cannot be deleted: " + std::strerror(errno) +
                  "; the limit stays in force until its end time");
  }
  std::printf("limit      none\n");
  return 0;
}

/// "any" without a limit for this direction.
std::string power_text(const std::string& power) {
  return power.empty() ? std::string(kAnyPowerText) : power;
}

int run_limit(const LimitOptions& options, SettingsFile& settings) {
  set_market_time_zone();
  const EdgeConfig& config = settings.config;
  const char* const path = config.site.limit_file.c_str();
  if (!config.site.settings.has_outside_limits) {
    return refuse(settings.path + ": [limits] file is missing: add it, then restart bess-edge");
  }
  if (options.clear) return clear(path);
  const std::string charge = power_text(options.charge_w);
  const std::string discharge = power_text(options.discharge_w);
  std::int32_t power_w = 0;
  for (const std::string* const text : {&charge, &discharge}) {
    if (parse_limit_power(*text, power_w)) continue;
    refuse("\"" + *text + "\" is not a power: use whole watts, 0 or more");
    return 2;
  }
  const std::int64_t until_utc_s = utc_seconds(config.clock) + options.for_s;
  const std::string until = utc_text(until_utc_s).c_str();
  if (!replace_file(path, charge + " " + discharge + " " + until + "\n")) {
    return refuse(std::string(path) + ": cannot be written: " + std::strerror(errno) +
                  "; the limit is unchanged; use a path below /run, in memory");
  }
  std::printf("limit      charge %s W, discharge %s W, until %s local time\n", charge.c_str(),
              discharge.c_str(), local_text(until_utc_s).c_str());
  return 0;
}

}  // namespace

void add_limit(EdgeCommand root) {
  EdgeCommand command =
      root.subcommand("limit", "limit charging or discharging power until an end time");
  const auto options = std::make_shared<LimitOptions>();
  command.option("--charge", options->charge_w, "charging power, W, 0 or more; default: no limit")
      .value_name("W");
  command
      .option("--discharge", options->discharge_w,
              "discharging power, W, 0 or more; default: no limit")
      .value_name("W");
  command.duration("--for", options->for_s, 1, "duration, up to 7d, such as 90s or 1h30m");
  command.flag("--clear", options->clear, "remove the limit").excludes("--for");
  command.footer(kLimitFooter);
  command.set_action(
      [options](SettingsFile& settings) { return run_limit(*options, settings); },
      [options] {
        const bool has_power = !options->charge_w.empty() || !options->discharge_w.empty();
        if (options->clear) return std::string(has_power ? "--clear takes no power" : "");
        if (options->for_s <= 0) return std::string("--for DURATION or --clear is missing");
        return std::string(has_power ? "" : "--charge W or --discharge W is missing");
      });
}

}  // namespace bess
