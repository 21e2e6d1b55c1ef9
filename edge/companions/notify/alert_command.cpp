#include "edge/companions/notify/notifier_state.h"

#include <vector>

#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::string text_of(const NotifySettings& settings, const Message& message) {
  std::string text = one_line(message.text) + "\n\n";
  if (message.since_utc_s != 0) {
    text += "since " + std::string(local_text(message.since_utc_s).view()) + "\n";
  }
  text += "seen at " + std::string(local_text(message.utc_s).view()) + " by bess-notify on " +
          settings.name + "\ndetails: bess-edge status, bess-edge log --last 20\n";
  if (!settings.contact.empty()) text += "call: " + settings.contact + "\n";
  return text;
}

}  // namespace

std::string headline(const Message& message) {
  const std::string before = message.severity == "alarm" ? "ALERT: "
                             : message.severity == "day" ? "day "
                                                         : message.severity + ": ";
  return before + one_line(message.text, 400);
}

std::string run_alert_command(const NotifySettings& settings, const Message& message,
                              const std::stop_token& stop) {
  const std::string text = text_of(settings, message);
  const std::string head = headline(message);
  const std::string title = head.substr(0, head.find(';'));  // what was found, without the remedy
  // Passed by env as separate words, so that the shell interprets no part of a text.
  const std::vector<std::string> words = {
      "/usr/bin/env",
      "BESS_SEVERITY=" + message.severity,
      "BESS_TITLE=[bess " + settings.name + "] " + one_line(title, 200),
      "BESS_TEXT=" + text,
      "BESS_NODE=" + settings.name,
      "BESS_KEY=" + one_line(message.key, 200),
      "BESS_UTC=" + std::string(utc_text(message.utc_s).view()),
      "/bin/sh",
      "-c",
      settings.command};
  const ProgramResult result = run_program(words, text, settings.command_ms_max, stop);
  if (!result.trouble.empty()) return "command: " + result.trouble;
  return result.exit_code == 0
             ? ""
             : "command: failed with exit code " + std::to_string(result.exit_code);
}

}  // namespace bess
