// One JSON object, posted: to chat programs, gateways, pagers.
#pragma once

#include <stop_token>
#include <string>

#include "edge/notify/message.h"

namespace bess {

struct NotifySettings;

/// https, or http to this very machine: what is told, and the secret in the URL, cross no wire in
/// clear.
bool is_allowed_webhook(const std::string& url);

/// Empty when it was answered with 2xx; else why not, without the URL, which may be a secret. Waits
/// no longer than the settings say.
std::string post_webhook(const NotifySettings& settings, const Message& message,
                         const std::stop_token& stop);

}  // namespace bess
