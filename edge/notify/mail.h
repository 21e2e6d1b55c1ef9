// Mail by the system's mailer, whatever stands behind its sendmail.
#pragma once

#include <stop_token>
#include <string>

#include "edge/notify/message.h"
#include "edge/notify/notify_settings.h"

namespace bess {

/// Headers and body as `sendmail -t` takes them.
std::string mail_text(const NotifySettings& settings, const Message& message);

/// Empty when the mailer took it; else why not. Waits no longer than the settings say.
std::string send_mail(const NotifySettings& settings, const Message& message,
                      const std::stop_token& stop);

}  // namespace bess
