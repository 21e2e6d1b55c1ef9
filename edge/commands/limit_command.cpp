#include "edge/commands/limit_command.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "edge/log/journal.h"
#include "edge/log/whole_file.h"

namespace bess {
namespace {

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

}  // namespace

int run_limit_command(const CommandLine& command_line, const EdgeConfig& config) {
  const char* const path = config.site.limit_file.c_str();
  if (!config.site.settings.has_outside_limits) {
    return refuse(command_line.config_path +
                  ": [limits] file is missing: add it, and restart bess-edge");
  }
  if (command_line.clear) return clear(path);
  const std::string charge = power_text(command_line.charge_w);
  const std::string discharge = power_text(command_line.discharge_w);
  std::int32_t power_w = 0;
  for (const std::string* const text : {&charge, &discharge}) {
    if (parse_limit_power(*text, power_w)) continue;
    refuse("\"" + *text + "\" is no power: whole watts, 0 or more");
    return 2;
  }
  const std::int64_t until_utc_s =
      config.clock.now_utc_ns() / kNanosecondsPerSecond + command_line.for_s;
  const std::string until = utc_text(until_utc_s).c_str();
  if (!replace_file(path, charge + " " + discharge + " " + until + "\n")) {
    return refuse(std::string(path) + ": cannot be written: " + std::strerror(errno) +
                  "; nothing has changed. It is best in memory, below /run");
  }
  std::printf("limit      charge %s W, discharge %s W, until %s\n", charge.c_str(),
              discharge.c_str(), until.c_str());
  return 0;
}

}  // namespace bess
