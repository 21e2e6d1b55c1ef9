#include "edge/notify/webhook.h"

#include <string_view>

#include "edge/notify/notify_settings.h"
#include "edge/prices/http_trust.h"
#include "shared/host/http_client.h"
#include "shared/host/text.h"

namespace bess {

bool is_allowed_webhook(const std::string& url) {
  const UrlTransport transport = transport_of(url);
  return transport == UrlTransport::kSecure || transport == UrlTransport::kLoopback;
}

std::string post_webhook(const NotifySettings& settings, const Message& message,
                         const std::stop_token& stop) {
  HttpRequest request{.url = settings.webhook_url,
                      .limits = {.deadline_s = settings.webhook_ms_max / 1'000.0},
                      .user_agent = "bess-notify",
                      .ca_file = settings.webhook_ca_file,
                      .authorities =
                          "install ca-certificates, or name the file of its own "
                          "authority, webhook_ca_file",
                      .post = message_json(settings.name, message)};
  std::string_view lines = settings.webhook_headers;
  while (!lines.empty()) request.headers.emplace_back(take_line(lines));
  const HttpOutcome outcome = http_request(request, [&] { return stop.stop_requested(); });
  if (outcome.kind == HttpOutcome::Kind::kDone) return "";
  return "webhook: " + (outcome.status == 0
                            ? outcome.reason
                            : "answered with HTTP " + std::to_string(outcome.status));
}

}  // namespace bess
