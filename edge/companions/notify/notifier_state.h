// Notifier state that survives a restart: sent alerts, last reported day, retry queue. One JSON
// text with a checksum, replaced atomically, in [notify] folder and, in case the disk fails, in
// run_folder.
#pragma once

#include <cstdint>
#include <deque>
#include <stop_token>
#include <string>
#include <vector>

#include "edge/companions/notify/notify_settings.h"

namespace bess {

// Notification command of the operator: `apprise`, `mail` or a script. /bin/sh runs it for each
// message with these environment variables:
//   BESS_SEVERITY  alarm, over (its end), day (yesterday in one line) or test
//   BESS_TITLE     "[bess NAME] ALERT: ...", one line
//   BESS_TEXT      the same with start time, commands and contact; also on standard input
//   BESS_NODE, BESS_KEY, BESS_UTC
// Exit code 0 means delivered. Otherwise, or after a minute, the command is repeated.

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

// Alert bookkeeping: each alert and its end are reported once. Pure, over UTC seconds.
//   one that lasts `after_s`                 is reported
//   one that returns within `after_s`        is the same
//   a reported one absent for `after_s`      is over, which is reported

/// A current alert. The key identifies it; numbers in the text may change.
struct SeenAlert {
  std::string key{};
  std::string text{};
};

struct ToldAlert {
  std::string key{};
  std::string text{};  ///< newest text
  std::int64_t since_utc_s = 0;
  std::int64_t seen_utc_s = 0;  ///< last observation
  bool is_told = false;
};

struct AlertEvent {
  bool is_over = false;
  ToldAlert alert{};
};

/// Updates `alerts`, oldest first, with the current alerts. Returns the events to report.
std::vector<AlertEvent> observe(std::vector<ToldAlert>& alerts, const std::vector<SeenAlert>& seen,
                                std::int64_t after_s, std::int64_t now_utc_s);

struct NotifierState {
  std::uint64_t number = 0;  ///< of the stored version
  std::string day{};         ///< newest day with a control cycle in the log; empty = none
  std::vector<ToldAlert> alerts{};
  std::deque<Message> pending{};  ///< oldest first
};

/// Newest stored state. A damaged or foreign file is named in `losses`, one line each, and counts
/// as empty.
NotifierState read_notifier_state(const std::vector<std::string>& paths,
                                  std::vector<std::string>& losses);

std::string notifier_state_text(const NotifierState& state);

/// Writes the text of `notifier_state_text` to every path and creates missing folders. Empty, or
/// one line with the failed path and the consequence.
std::string write_notifier_state(const std::vector<std::string>& paths, const std::string& text);

}  // namespace bess
