#include "workstation/market/feed/http_client.h"

#include <curl/curl.h>
#include <fmt/core.h>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <memory>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/market/feed/transfer_trouble.h"

namespace bess {
namespace {

using Kind = HttpOutcome::Kind;

constexpr long kConnectTimeout_s = 20;
constexpr std::size_t kReasonMax = 200;  // of a server's own words in a message
constexpr std::size_t kHeaderBytesMax = 100'000;

struct Received {
  std::string body;
  std::size_t bytes_max = 0;
  bool is_too_large = false;
  std::size_t header_bytes = 0;  ///< of all answers, those of redirects too
};

std::size_t take_body(char* data, std::size_t size, std::size_t count, void* user) {
  auto& received = *static_cast<Received*>(user);
  received.is_too_large = received.body.size() + size * count > received.bytes_max;
  if (received.is_too_large) return 0;
  received.body.append(data, size * count);
  return size * count;
}

std::size_t take_header(char*, std::size_t size, std::size_t count, void* user) {
  auto& received = *static_cast<Received*>(user);
  received.header_bytes += size * count;
  return received.header_bytes > kHeaderBytesMax ? 0 : size * count;
}

/// Of the answer itself, not of redirects or a proxy; empty when it has none of that name.
std::string_view header(CURL* curl, const char* name) {
  curl_header* found = nullptr;
  const bool is_there = curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &found) == CURLHE_OK;
  return is_there ? found->value : "";
}

/// libcurl calls it at least once a second, also while it waits.
int stop_when_interrupted(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return *static_cast<const std::atomic<bool>*>(user) ? 1 : 0;
}

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Of a transfer that did not come to its end.
HttpOutcome outcome_of_failure(CURL* curl, CURLcode code, const Received& received,
                               const HttpLimits& limits, const char* error_text) {
  double took_s = 0;
  curl_easy_getinfo(curl, CURLINFO_TOTAL_TIME, &took_s);
  // libcurl itself ends a single header of 100 kB, by saying that memory is short.
  if (received.header_bytes > kHeaderBytesMax || code == CURLE_OUT_OF_MEMORY) {
    return {Kind::kRefused,
            {},
            fmt::format("the answer's headers have no end: more than {} bytes of them are none",
                        kHeaderBytesMax),
            {}};
  }
  if (received.is_too_large) {
    return {Kind::kRefused,
            {},
            fmt::format("the answer is larger than {} bytes, more than is meant here",
                        limits.bytes_max),
            {}};
  }
  if (code == CURLE_OPERATION_TIMEDOUT && took_s >= 0.95 * limits.deadline_s) {
    return {Kind::kSlow,
            {},
            fmt::format("the answer was not whole after {:g} s ({})", limits.deadline_s,
                        counted(received.body.size(), "byte")),
            {}};
  }
  const bool has_begun = !received.body.empty();
  if (code == CURLE_OPERATION_TIMEDOUT && has_begun) {
    return {Kind::kSlow,
            {},
            fmt::format("the answer came too slowly, less than {} bytes a second for {} s",
                        limits.bytes_per_s_min, limits.slow_s),
            {}};
  }
  const bool is_silent = code == CURLE_RECV_ERROR && received.header_bytes == 0;
  TransferTrouble trouble = transfer_trouble(is_silent ? CURLE_GOT_NOTHING : code, error_text);
  return {trouble.kind, {}, std::move(trouble.reason), {}};
}

/// libcurl reports a body that ends before its frames, chunks or length do. It cannot where an
/// HTTP/1 connection's end is the body's, and says nothing of a packed text that breaks off: then
/// the text must end as a whole one does.
bool is_whole(CURL* curl, std::string_view body) {
  if (looks_like_json(body)) return Json::parse(body).value().exists();
  long version = 0;
  curl_off_t length = -1;
  curl_easy_getinfo(curl, CURLINFO_HTTP_VERSION, &version);
  curl_easy_getinfo(curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
  const bool is_framed = version >= CURL_HTTP_VERSION_2_0 || length >= 0 ||
                         header(curl, "Transfer-Encoding") == "chunked";
  return body.ends_with('\n') || (is_framed && header(curl, "Content-Encoding").empty());
}

HttpOutcome outcome_of_status(CURL* curl, long status, Received received) {
  if (status == 200) {
    if (!is_whole(curl, received.body)) {
      return {Kind::kTransient, {}, "the answer was cut short", {}};
    }
    return {Kind::kDone, std::move(received.body), {}, {}};
  }
  const std::string_view retry_after = header(curl, "Retry-After");
  const std::string told(retry_after.empty() ? header(curl, "X-RateLimit-Reset") : retry_after);
  const std::string body = one_line(received.body, kReasonMax);
  const std::string reason =
      fmt::format("the server answered {}{}{}", status, body.empty() ? "" : ": ", body);
  if (status == 429 || status == 503) {
    return {Kind::kBusy, {}, reason, wait_seconds(told, now_s())};
  }
  // 501 and 505: the server cannot do what is asked, now or later.
  const bool may_pass = status == 408 || (status >= 500 && status != 501 && status != 505);
  return {may_pass ? Kind::kTransient : Kind::kRefused, {}, reason, {}};
}

struct Cleanup {
  void operator()(CURL* curl) const { curl_easy_cleanup(curl); }
};
using Handle = std::unique_ptr<CURL, Cleanup>;

Handle new_handle() {
  static const CURLcode started = curl_global_init(CURL_GLOBAL_DEFAULT);
  Handle curl(started == CURLE_OK ? curl_easy_init() : nullptr);
  if (!curl) fail("libcurl cannot be started");
  return curl;
}

/// `encoding`: what libcurl may be sent and unpacks; "" = all that it can.
HttpOutcome get(const std::string& url, const char* encoding, const std::atomic<bool>& interrupted,
                const HttpLimits& limits) {
  const Handle curl = new_handle();
  Received received;
  received.bytes_max = limits.bytes_max;
  char error_text[CURL_ERROR_SIZE] = "";
  curl_easy_setopt(curl.get(), CURLOPT_URL, url.c_str());
  curl_easy_setopt(curl.get(), CURLOPT_PROTOCOLS_STR, "http,https");
  curl_easy_setopt(curl.get(), CURLOPT_REDIR_PROTOCOLS_STR, redirect_protocols(url));
  curl_easy_setopt(curl.get(), CURLOPT_FOLLOWLOCATION, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_MAXREDIRS, 5L);
  curl_easy_setopt(curl.get(), CURLOPT_SSL_VERIFYPEER, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_SSL_VERIFYHOST, 2L);
  // As the curl command does: a proxy that opens TLS has an authority of its own.
  if (const char* const authorities = std::getenv("SSL_CERT_FILE")) {
    curl_easy_setopt(curl.get(), CURLOPT_CAINFO, authorities);
  }
  curl_easy_setopt(curl.get(), CURLOPT_CONNECTTIMEOUT, kConnectTimeout_s);
  curl_easy_setopt(curl.get(), CURLOPT_TIMEOUT_MS, static_cast<long>(1000 * limits.deadline_s));
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_LIMIT, limits.bytes_per_s_min);
  curl_easy_setopt(curl.get(), CURLOPT_LOW_SPEED_TIME, limits.slow_s);
  curl_easy_setopt(curl.get(), CURLOPT_ACCEPT_ENCODING, encoding);
  curl_easy_setopt(curl.get(), CURLOPT_USERAGENT, "bess-train/" BESS_VERSION);
  curl_easy_setopt(curl.get(), CURLOPT_NOSIGNAL, 1L);
  curl_easy_setopt(curl.get(), CURLOPT_ERRORBUFFER, error_text);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEFUNCTION, take_body);
  curl_easy_setopt(curl.get(), CURLOPT_WRITEDATA, &received);
  curl_easy_setopt(curl.get(), CURLOPT_HEADERFUNCTION, take_header);
  curl_easy_setopt(curl.get(), CURLOPT_HEADERDATA, &received);
  curl_easy_setopt(curl.get(), CURLOPT_NOPROGRESS, 0L);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFOFUNCTION, stop_when_interrupted);
  curl_easy_setopt(curl.get(), CURLOPT_XFERINFODATA, &interrupted);
  const CURLcode code = curl_easy_perform(curl.get());
  if (code != CURLE_OK) {
    return outcome_of_failure(curl.get(), code, received, limits, error_text);
  }
  long status = 0;
  curl_easy_getinfo(curl.get(), CURLINFO_RESPONSE_CODE, &status);
  HttpOutcome outcome = outcome_of_status(curl.get(), status, std::move(received));
  // A packed text without a last line end is asked for once more, plain: then its length tells.
  const bool is_unclear = status == 200 && outcome.kind == Kind::kTransient &&
                          !header(curl.get(), "Content-Encoding").empty();
  return is_unclear && *encoding == '\0' ? get(url, "identity", interrupted, limits) : outcome;
}

}  // namespace

const char* redirect_protocols(const std::string& url) {
  return url.starts_with("https://") ? "https" : "http,https";
}

std::string url_encoded(const std::string& text) {
  const Handle curl = new_handle();
  char* escaped = curl_easy_escape(curl.get(), text.data(), static_cast<int>(text.size()));
  std::string result = escaped;
  curl_free(escaped);
  return result;
}

std::string describe_wait(double wait_s) {
  if (wait_s >= kWaitMax_s) return "a day or longer";
  return wait_s >= 120 ? fmt::format("{:.0f} minutes", wait_s / 60)
                       : fmt::format("{:.0f} s", wait_s);
}

std::optional<double> wait_seconds(const std::string& header_value, double now_utc_s) {
  double number = 0;
  const char* end = header_value.data() + header_value.size();
  const auto [stop, error] = std::from_chars(header_value.data(), end, number);
  if (error == std::errc::result_out_of_range && stop == end) return kWaitMax_s;
  if (error == std::errc{} && stop == end && !std::isnan(number)) {
    constexpr double kSmallestTimestamp = 1e9;  // September 2001; nobody is told to wait so long
    return std::clamp(number < kSmallestTimestamp ? number : number - now_utc_s, 0.0, kWaitMax_s);
  }
  std::int64_t utc_s = 0;
  if (!parse_utc(header_value, utc_s, kAlsoBlank))
    utc_s = curl_getdate(header_value.c_str(), nullptr);
  if (utc_s <= 0) return std::nullopt;
  return std::clamp(static_cast<double>(utc_s) - now_utc_s, 0.0, kWaitMax_s);
}

HttpOutcome http_get(const std::string& url, const std::atomic<bool>& interrupted,
                     const HttpLimits& limits) {
  return get(url, "", interrupted, limits);
}

}  // namespace bess
