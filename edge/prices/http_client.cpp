#include "edge/prices/http_client.h"

#include <curl/curl.h>

#include <cstring>
#include <memory>

#include "edge/base/check.h"
#include "edge/memory/static_arena.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr long kCaCacheS = 86'400;  // a new bundle of certificates is read within a day

using List = std::unique_ptr<curl_slist, decltype(&curl_slist_free_all)>;

Status status_of_curl(CURLcode code) {
  switch (code) {
    case CURLE_OPERATION_TIMEDOUT:
      return Status::kTimeout;
    case CURLE_WRITE_ERROR:
      return Status::kTooLarge;
    case CURLE_COULDNT_RESOLVE_HOST:
      return Status::kNameUnresolved;
    case CURLE_SSL_CONNECT_ERROR:
    case CURLE_SSL_CACERT_BADFILE:
    case CURLE_SSL_CERTPROBLEM:
    case CURLE_PEER_FAILED_VERIFICATION:
      return Status::kTlsRefused;
    case CURLE_URL_MALFORMAT:
    case CURLE_UNSUPPORTED_PROTOCOL:
      return Status::kHttpError;
    case CURLE_OUT_OF_MEMORY:
      return Status::kNoMemory;
    default:
      return Status::kNotConnected;
  }
}

std::int64_t deadline_after_ms(std::int32_t ms) {
  return clock_ns(CLOCK_MONOTONIC) + ms * (kNanosecondsPerSecond / 1'000);
}

bool is_redirect(long http_code) { return http_code >= 300 && http_code < 400; }

}  // namespace

HttpClient::HttpClient(const HttpSettings& settings) : settings_(settings) {
  // Loads OpenSSL's configuration, algorithms and texts as well: nothing of it is left for later.
  BESS_CHECK(curl_global_init(CURL_GLOBAL_DEFAULT) == CURLE_OK);
  curl_ = curl_easy_init();
  BESS_CHECK(curl_ != nullptr);
  set_options();
  set_headers();
  static_cast<void>(origin_.set_url(settings_.url.c_str()));  // a bad URL fails at every `get`
  if (!origin_.is_name()) return;
  warm_up_resolver();
  static_cast<void>(origin_.refresh(clock_ns(CLOCK_MONOTONIC), settings_.resolve_every_s));
}

HttpClient::~HttpClient() {
  curl_easy_cleanup(curl_);
  curl_slist_free_all(static_cast<curl_slist*>(headers_));
}

void HttpClient::set_options() {
  CURL* curl = curl_;
  curl_easy_setopt(curl, CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl, CURLOPT_HTTP_VERSION, CURL_HTTP_VERSION_1_1);
  curl_easy_setopt(curl, CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl, CURLOPT_FOLLOWLOCATION, 0L);  // `get` does it, and looks up the names
  curl_easy_setopt(curl, CURLOPT_PROXY, "");
  curl_easy_setopt(curl, CURLOPT_USERAGENT, "bess-edge");
  curl_easy_setopt(curl, CURLOPT_SSLVERSION, CURL_SSLVERSION_TLSv1_2);
  curl_easy_setopt(curl, CURLOPT_CAINFO, settings_.ca_file.c_str());
  curl_easy_setopt(curl, CURLOPT_CAPATH, nullptr);  // else the store is parsed at each handshake
  curl_easy_setopt(curl, CURLOPT_CA_CACHE_TIMEOUT, kCaCacheS);
  curl_easy_setopt(curl, CURLOPT_WRITEFUNCTION, &HttpClient::on_body);
  curl_easy_setopt(curl, CURLOPT_WRITEDATA, this);
  curl_easy_setopt(curl, CURLOPT_HEADERFUNCTION, &HttpClient::on_header);
  curl_easy_setopt(curl, CURLOPT_HEADERDATA, this);
}

void HttpClient::set_headers() {
  std::string_view lines = settings_.headers.view();
  curl_slist* list = curl_slist_append(nullptr, "Accept: application/json");
  while (!lines.empty()) {
    const std::size_t end = lines.find('\n');
    const FixedText<2047> line(lines.substr(0, end));
    list = curl_slist_append(list, line.c_str());
    lines = end == std::string_view::npos ? std::string_view{} : lines.substr(end + 1);
  }
  BESS_CHECK(list != nullptr);
  headers_ = list;
}

Status HttpClient::get(std::string_view& body) {
  return fetch(settings_.url.c_str(), deadline_after_ms(settings_.timeout_ms), body);
}

Status HttpClient::get(const char* url, std::int32_t timeout_ms, std::string_view& body) {
  HostAddresses host;
  if (host.set_url(url) != Status::kOk || !host.is_same_host(origin_)) return Status::kMalformed;
  return fetch(url, deadline_after_ms(timeout_ms), body);
}

Status HttpClient::fetch(const char* url, std::int64_t deadline_ns, std::string_view& body) {
  const std::int64_t refusals = arena_statistics().failures;
  Status status = perform(url, origin_, true, deadline_ns);
  FixedText<1023> target;
  HostAddresses elsewhere;
  for (int i = 0; status == Status::kOk && i < kRedirectsMax; ++i) {
    status = take_redirect(target);
    if (status != Status::kOk || target.empty()) break;
    status = elsewhere.set_url(target.c_str());
    if (status != Status::kOk) break;
    const bool is_home = elsewhere.is_same_host(origin_);
    status = perform(target.c_str(), is_home ? origin_ : elsewhere, is_home, deadline_ns);
  }
  // OpenSSL hides want of memory behind errors of its own; the arena knows.
  if (status != Status::kOk && arena_statistics().failures != refusals) return Status::kNoMemory;
  if (status != Status::kOk) return status;
  long http_code = 0;
  curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &http_code);
  body = {answer_, answer_size_};
  return http_code == 200 ? Status::kOk : Status::kHttpError;
}

Status HttpClient::perform(const char* url, HostAddresses& host, bool with_headers,
                           std::int64_t deadline_ns) {
  // Lookups were prepared for before the seal only if the configured host is a name itself.
  if (host.is_name() && !origin_.is_name()) return Status::kNameUnresolved;
  Status status = host.refresh(clock_ns(CLOCK_MONOTONIC), settings_.resolve_every_s);
  if (status != Status::kOk) return status;
  const List addresses(host.is_name() ? curl_slist_append(nullptr, host.entry()) : nullptr,
                       &curl_slist_free_all);
  if (host.is_name() && addresses == nullptr) return Status::kNoMemory;
  const std::int64_t left_ms = (deadline_ns - clock_ns(CLOCK_MONOTONIC)) / 1'000'000;
  if (left_ms <= 0) return Status::kTimeout;
  curl_easy_setopt(curl_, CURLOPT_TIMEOUT_MS, static_cast<long>(left_ms));
  curl_easy_setopt(curl_, CURLOPT_CONNECTTIMEOUT_MS, static_cast<long>(left_ms));
  header_size_ = answer_size_ = 0;
  if (curl_easy_setopt(curl_, CURLOPT_URL, url) != CURLE_OK) return Status::kNoMemory;
  curl_easy_setopt(curl_, CURLOPT_RESOLVE, addresses.get());
  curl_easy_setopt(curl_, CURLOPT_HTTPHEADER, with_headers ? headers_ : nullptr);
  const CURLcode code = curl_easy_perform(curl_);
  curl_easy_setopt(curl_, CURLOPT_RESOLVE, nullptr);
  curl_off_t connected_us = 0;
  curl_easy_getinfo(curl_, CURLINFO_APPCONNECT_TIME_T, &connected_us);
  status = code == CURLE_OK ? Status::kOk : status_of_curl(code);
  if (code != CURLE_OK && connected_us == 0) host.expire();  // perhaps it has moved
  return status;
}

Status HttpClient::take_redirect(FixedText<1023>& target) {
  target = {};
  long http_code = 0;
  char* url = nullptr;
  curl_easy_getinfo(curl_, CURLINFO_RESPONSE_CODE, &http_code);
  curl_easy_getinfo(curl_, CURLINFO_REDIRECT_URL, &url);
  if (!is_redirect(http_code) || url == nullptr) return Status::kOk;
  if (!std::string_view(url).starts_with("https://")) return Status::kHttpError;
  return target.assign(url) ? Status::kOk : Status::kHttpError;
}

std::size_t HttpClient::on_body(char* bytes, std::size_t size, std::size_t count, void* client) {
  auto* self = static_cast<HttpClient*>(client);
  const std::size_t added = size * count;
  if (added > kAnswerBytesMax - self->answer_size_) return 0;  // aborts the transfer
  std::memcpy(self->answer_ + self->answer_size_, bytes, added);
  self->answer_size_ += added;
  return added;
}

std::size_t HttpClient::on_header(char*, std::size_t size, std::size_t count, void* client) {
  auto* self = static_cast<HttpClient*>(client);
  self->header_size_ += size * count;
  return self->header_size_ > kHeaderBytesMax ? 0 : size * count;
}

}  // namespace bess
