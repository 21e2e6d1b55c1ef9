#include "edge/notify/connection_trouble.h"

#include <curl/curl.h>

#include <memory>

#include "shared/host/transfer_trouble.h"

namespace bess {
namespace {

int stop_when_asked(void* stop, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return static_cast<const std::stop_token*>(stop)->stop_requested() ? 1 : 0;
}

}  // namespace

std::string probe_connection(const Place& place, const std::string& authorities,
                             const std::stop_token& stop) {
  constexpr long kProbeMsMax = 10'000;
  const std::unique_ptr<CURL, decltype(&curl_easy_cleanup)> curl(curl_easy_init(),
                                                                 &curl_easy_cleanup);
  if (curl == nullptr) return "no memory";
  const bool is_ipv6 = place.host.find(':') != std::string::npos;
  const std::string host = is_ipv6 ? "[" + place.host + "]" : place.host;
  const std::string url = (place.ca_file.empty() ? "http://" : "https://") + host;
  curl_easy_setopt(curl.get(), CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_PORT, static_cast<long>(place.port));
  curl_easy_setopt(curl.get(), CURLOPT_CONNECT_ONLY, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_PROXY, "");
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_TIMEOUT_MS, kProbeMsMax);
  curl_easy_setopt(curl.get(), CURLOPT_SSL_ENABLE_ALPN, 0L);
  if (!place.ca_file.empty()) {
    curl_easy_setopt(curl.get(), CURLOPT_CAINFO, place.ca_file.c_str());
    curl_easy_setopt(curl.get(), CURLOPT_CAPATH, nullptr);
  }
  char detail[CURL_ERROR_SIZE] = "";
  curl_easy_setopt(curl.get(), CURLOPT_ERRORBUFFER, detail);
  curl_easy_setopt(curl.get(), CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFOFUNCTION, stop_when_asked);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFODATA, const_cast<std::stop_token*>(&stop));
  const CURLcode code = curl_easy_perform(curl.get());
  return code == CURLE_OK ? "" : transfer_trouble(curl.get(), code, detail, authorities).reason;
}

}  // namespace bess
