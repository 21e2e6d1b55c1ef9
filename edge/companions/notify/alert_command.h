// Notification command of the operator: `apprise`, `mail` or a script. /bin/sh runs it for each
// message with these environment variables:
//   BESS_SEVERITY  alarm, over (its end), day (yesterday in one line) or test
//   BESS_TITLE     "[bess NAME] ALERT: ...", one line
//   BESS_TEXT      the same with start time, commands and contact; also on standard input
//   BESS_NODE, BESS_KEY, BESS_UTC
// Exit code 0 means delivered. Otherwise, or after a minute, the command is repeated.
#pragma once

#include <cstdint>
#include <stop_token>
#include <string>

#include "edge/companions/notify/notify_settings.h"

namespace bess {

struct Message {
  std::string severity = "test";
  std::string key{};             ///< of the alert; for a day, its date
  std::string text{};            ///< one line
  std::int64_t utc_s = 0;        ///< time of observation; delivery may be much later
  std::int64_t since_utc_s = 0;  ///< start of an alert; 0 for other messages
};

/// "ALERT: ...", one line.
std::string headline(const Message& message);

/// Empty when delivered; else the error. Returns soon after a stop request.
std::string run_alert_command(const NotifySettings& settings, const Message& message,
                              const std::stop_token& stop = {});

}  // namespace bess
