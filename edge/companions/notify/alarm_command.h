// The operator's command: `apprise`, `mail` or a script. /bin/sh runs it for each message, with
//   BESS_SEVERITY  alarm, over (its end), day (yesterday in a line) or test
//   BESS_TITLE     "[bess NAME] ALARM: ...", one line
//   BESS_TEXT      the same with since when, what to run and whom to call; also its input
//   BESS_NODE, BESS_KEY, BESS_UTC
// in its environment. Exit code 0 means delivered; otherwise, or after a minute, it is run again.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "edge/companions/notify/notify_settings.h"

namespace bess {

struct Message {
  std::string severity = "test";
  std::string key{};             ///< of the alarm; of the day, its date
  std::string text{};            ///< one line
  std::int64_t utc_s = 0;        ///< when it was observed; it may be delivered much later
  std::int64_t since_utc_s = 0;  ///< of an alarm and its end; 0 = of something else
};

/// "ALARM: ...", one line.
std::string headline(const Message& message);

/// Empty when the command took it; else why not. Gives up soon once it is asked to stop.
std::string run_alarm_command(const NotifySettings& settings, const Message& message,
                              const std::stop_token& stop = {});

}  // namespace bess
