#include "edge/notify/mail.h"

#include "shared/host/run_program.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {

std::string mail_text(const NotifySettings& settings, const Message& message) {
  std::string text = "To: " + one_line(settings.mail_to) + "\n";
  if (!settings.mail_from.empty()) text += "From: " + one_line(settings.mail_from) + "\n";
  text += "Subject: [bess " + settings.name + "] " + one_line(headline(message), 200) + "\n";
  // Machines must not answer, and a vacation reply is one.
  text += "Auto-Submitted: auto-generated\nMIME-Version: 1.0\n";
  text += "Content-Type: text/plain; charset=UTF-8\n\n";
  text += one_line(message.text) + "\n\n";
  if (message.since_utc_s != 0) {
    text += "since " + std::string(utc_text(message.since_utc_s).view()) + "\n";
  }
  text += "seen at " + std::string(utc_text(message.utc_s).view()) + " by bess-notify on " +
          settings.name + "\nmore: bess-edge status, bess-edge log --last 20\n";
  if (!settings.contact.empty()) text += "call: " + settings.contact + "\n";
  return text;
}

std::string send_mail(const NotifySettings& settings, const Message& message,
                      const std::stop_token& stop) {
  const ProgramResult result = run_program(
      {settings.sendmail, "-t", "-i"}, mail_text(settings, message), settings.mailer_ms_max, stop);
  if (!result.trouble.empty() || result.exit_code == 0) return result.trouble;
  return settings.sendmail + " failed with exit code " + std::to_string(result.exit_code);
}

}  // namespace bess
