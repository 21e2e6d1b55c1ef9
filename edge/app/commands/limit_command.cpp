// `bess-edge limit`: caps the battery's power for a while, by the file that [limits] names. What a
// site controller that speaks no such file calls, and a person.
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "edge/app/commands/command.h"
#include "edge/records/log/journal.h"
#include "edge/records/log/whole_file.h"

namespace bess {
namespace {

struct LimitGiven {
  std::string charge_w;  ///< empty = any
  std::string discharge_w;
  bool clear = false;
  std::int64_t for_s = 0;  ///< 0 = not given
};

constexpr const char* kFooter =
    R"(Writes one line, "charge_w discharge_w utc_until", into the file of [limits], in place of the
one before; any program may write it itself, beside and renamed. A running controller looks every
few seconds and cuts an order that is too large at once. After its time the limit is gone, or with
on_timeout = "idle" the battery is left at 0 W until a new one comes: then --clear does that too.
Exit codes:
  0 done
  1 no [limits], or the file cannot be written
  2 the command line is wrong
Examples:
  bess-edge limit --charge 0 --for 15m
  bess-edge limit --charge 2000 --discharge 1000 --for 2h
  bess-edge limit --clear)";

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

void add_limit(EdgeCommand root) {
  EdgeCommand command = root.subcommand("limit", "limit charging or discharging power for a while");
  const auto given = std::make_shared<LimitGiven>();
  command.option("--charge", given->charge_w, "charging power, 0 or more; default: no limit")
      .value_name("W");
  command
      .option("--discharge", given->discharge_w, "discharging power, 0 or more; default: no limit")
      .value_name("W");
  command.duration("--for", given->for_s, 1,
                   "then the limit has lapsed: 90s, 15m, 1h30m, up to 7d");
  command.flag("--clear", given->clear, "remove the limit").excludes("--for");
  command.footer(kFooter);
  command.does([given](SettingsFile& settings) { return run_limit(*given, settings); },
               [given] {
                 const bool is_complete = given->clear || given->for_s > 0;
                 return std::string(is_complete ? "" : "--for DURATION or --clear is missing");
               });
}

}  // namespace bess
