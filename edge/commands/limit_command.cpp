// `bess-edge limit`: caps the battery's power for a while, by the file that [limits] names. What a
// site controller that speaks no such file calls, and a person.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "edge/commands/command_list.h"
#include "edge/log/journal.h"
#include "edge/log/whole_file.h"

namespace bess {
namespace {

struct LimitGiven {
  std::string charge_w;  ///< empty = any
  std::string discharge_w;
  bool clear = false;
  std::int64_t for_s = 0;  ///< 0 = not given
};

using O = OptionsOf<LimitGiven>;
constexpr CommandOption kOptions[] = {
    O::text<&LimitGiven::charge_w>("--charge"),
    O::text<&LimitGiven::discharge_w>("--discharge"),
    O::duration<&LimitGiven::for_s, 1>("--for"),
    O::flag<&LimitGiven::clear>("--clear"),
};

constexpr const char* kHelp =
    R"(bess-edge limit: caps the battery's power for a while, whatever prices and student say

  bess-edge limit [--config FILE] [--charge W] [--discharge W] --for DURATION
  bess-edge limit [--config FILE] --clear

  --config FILE   the controller's settings, with [limits] file; default /etc/bess/edge.toml
  --charge W      no order charges with more; 0 or more; default: any
  --discharge W   no order discharges with more
  --for DURATION  then the limit has lapsed: 90s, 15m, 1h30m, up to 7d
  --clear         takes the limit away

Writes one line, "charge_w discharge_w utc_until", into the file of [limits], in place of the one
before; any program may write it itself, beside and renamed. A running controller looks every few
seconds and cuts an order that is too large at once. After its time the limit is gone, or with
on_timeout = "idle" the battery is left at 0 W until a new one comes: then --clear does that too.
Exit codes: 0 done   1 no [limits], or the file cannot be written   2 the command line is bad

  bess-edge limit --charge 0 --for 15m
  bess-edge limit --charge 2000 --discharge 1000 --for 2h
  bess-edge limit --clear
)";

const char* complaint(const LimitGiven& given) {
  return given.clear == (given.for_s == 0) ? nullptr
                                           : "limit needs either --for DURATION or --clear";
}

int refuse(const std::string& message) {
  report(JournalLevel::kError, "limit: %s", message.c_str());
  return 1;
}

int clear(const char* path) {
  if (unlink(path) != 0 && errno != ENOENT) {
    return refuse(std::string(path) + ": cannot be taken away: " + std::strerror(errno) +
                  "; it stays in force until its end");
  }
  std::printf("limit      none\n");
  return 0;
}

/// "any" where the command line says nothing of this direction.
std::string power_text(const std::string& power) {
  return power.empty() ? std::string(kAnyPowerText) : power;
}

int run_limit(const LimitGiven& given, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  const char* const path = config.site.limit_file.c_str();
  if (!config.site.settings.has_outside_limits) {
    return refuse(settings.path + ": [limits] file is missing: add it, and restart bess-edge");
  }
  if (given.clear) return clear(path);
  const std::string charge = power_text(given.charge_w);
  const std::string discharge = power_text(given.discharge_w);
  std::int32_t power_w = 0;
  for (const std::string* const text : {&charge, &discharge}) {
    if (parse_limit_power(*text, power_w)) continue;
    refuse("\"" + *text + "\" is no power: whole watts, 0 or more");
    return 2;
  }
  const std::int64_t until_utc_s = config.clock.now_utc_ns() / kNanosecondsPerSecond + given.for_s;
  const std::string until = utc_text(until_utc_s).c_str();
  if (!replace_file(path, charge + " " + discharge + " " + until + "\n")) {
    return refuse(std::string(path) + ": cannot be written: " + std::strerror(errno) +
                  "; nothing has changed. It is best in memory, below /run");
  }
  std::printf("limit      charge %s W, discharge %s W, until %s\n", charge.c_str(),
              discharge.c_str(), until.c_str());
  return 0;
}

}  // namespace

const EdgeCommand kLimitCommand = {.name = "limit",
                                   .usage = "limit [--config FILE] ...",
                                   .does = "caps the power for a while",
                                   .help = kHelp,
                                   .options = kOptions,
                                   .run = run_with<LimitGiven, run_limit, complaint>};

}  // namespace bess
