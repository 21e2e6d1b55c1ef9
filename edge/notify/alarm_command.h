// The operator's command: `apprise`, `mail` or a script. /bin/sh runs it for each message, with
//   BESS_SEVERITY  alarm, over (its end), day (yesterday in a line), test or dropped
//   BESS_TITLE     "[bess NAME] ALARM: ...", one line
//   BESS_TEXT      the same with since when, what to run and whom to call; also its input
//   BESS_NODE, BESS_KEY, BESS_UTC
// in its environment. Exit code 0 means delivered; otherwise, or after a minute, it is retried.
#pragma once

#include <stop_token>
#include <string>

#include "edge/notify/message.h"
#include "edge/notify/notify_settings.h"

namespace bess {

/// Empty when the command took it; else why not.
std::string run_alarm_command(const NotifySettings& settings, const Message& message,
                              const std::stop_token& stop);

}  // namespace bess
