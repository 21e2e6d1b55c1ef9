#include "edge/notify/webhook.h"

#include <arpa/inet.h>

#include <string_view>

#include "edge/notify/connection_trouble.h"
#include "edge/notify/curl_handle.h"
#include "edge/notify/notify_settings.h"
#include "shared/host/text.h"

namespace bess {
namespace {

std::string part_of(const CurlUrl& url, CURLUPart part) {
  char* text = nullptr;
  if (curl_url_get(url.get(), part, &text, 0) != CURLUE_OK) return "";
  return CurlText(text).get();
}

/// A name would be the resolver's to decide.
bool is_this_machine(const std::string& host) {
  in_addr address{};
  if (host == "[::1]") return true;
  return inet_pton(AF_INET, host.c_str(), &address) == 1 && ntohl(address.s_addr) >> 24 == 127;
}

void add_header(CurlList& list, const std::string& line) {
  curl_slist* const longer = curl_slist_append(list.get(), line.c_str());
  if (longer == nullptr) return;
  static_cast<void>(list.release());
  list.reset(longer);
}

CurlList headers_of(const NotifySettings& settings) {
  CurlList list;
  add_header(list, "Content-Type: application/json");
  std::string_view lines = settings.webhook_headers;
  while (!lines.empty()) add_header(list, std::string(take_line(lines)));
  return list;
}

std::size_t forget(char*, std::size_t size, std::size_t count, void*) { return size * count; }

}  // namespace

void prepare_webhooks() { curl_global_init(CURL_GLOBAL_DEFAULT); }

bool is_allowed_webhook(const std::string& url) {
  const CurlUrl parsed(curl_url());
  if (curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK) return false;
  const std::string scheme = part_of(parsed, CURLUPART_SCHEME);
  return scheme == "https" ||
         (scheme == "http" && is_this_machine(part_of(parsed, CURLUPART_HOST)));
}

std::string post_webhook(const NotifySettings& settings, const Message& message,
                         const std::stop_token& stop) {
  const Curl curl(curl_easy_init());
  if (curl == nullptr) return "webhook: no memory";
  const std::string body = message_json(settings.name, message);
  const CurlList headers = headers_of(settings);
  curl_easy_setopt(curl.get(), CURLOPT_URL, settings.webhook_url.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl.get(), CURLOPT_FOLLOWLOCATION,
                   0L);  // a redirect would take the secret along
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_TIMEOUT_MS, static_cast<long>(settings.webhook_ms_max));
  curl_easy_setopt(curl.get(), CURLOPT_USERAGENT, "bess-notify");
  curl_easy_setopt(curl.get(), CURLOPT_HTTPHEADER, headers.get());
  curl_easy_setopt(curl.get(), CURLOPT_POSTFIELDS, body.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_WRITEFUNCTION, forget);
  if (!settings.webhook_ca_file.empty()) {
    curl_easy_setopt(curl.get(), CURLOPT_CAINFO, settings.webhook_ca_file.c_str());
  }
  const std::string trouble = perform_transfer(
      curl.get(), "install ca-certificates, or name the file of its own authority, webhook_ca_file",
      stop);
  if (!trouble.empty()) return "webhook: " + trouble;
  long http_code = 0;
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &http_code);
  if (http_code >= 200 && http_code < 300) return "";
  return "webhook: answered with HTTP " + std::to_string(http_code);
}

}  // namespace bess
