// Mail by the system's mailer, whatever stands behind its sendmail.
#pragma once

#include <string>

#include "edge/notify/message.h"
#include "edge/notify/notify_settings.h"

namespace bess {

/// Headers and body as `sendmail -t` takes them.
std::string mail_text(const NotifySettings& settings, const Message& message);

/// Empty when the mailer took it; else why not.
std::string send_mail(const NotifySettings& settings, const Message& message);

}  // namespace bess
