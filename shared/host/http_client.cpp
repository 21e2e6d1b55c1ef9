#include "shared/host/http_client.h"

#include <curl/curl.h>
#include <netdb.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <map>
#include <memory>
#include <mutex>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

using Kind = HttpOutcome::Kind;

constexpr std::size_t kDetailMax = 200;  // of a library message

/// OpenSSL verification results (x509_vfy.h), from libcurl.
enum Verdict : long {
  kNoIssuer = 2,
  kNotYetValid = 9,
  kExpired = 10,
  kSelfSigned = 18,
  kSelfSignedInChain = 19,
  kNoLocalIssuer = 20,
  kLeafNotVerified = 21,
  kUntrusted = 27
};

HttpOutcome failure(Kind kind, std::string reason) {
  return {.kind = kind, .reason = std::move(reason)};
}

bool has(const std::string& text, const char* part) { return text.find(part) != text.npos; }

std::string certificate_trouble(CURL* curl, const std::string& authorities) {
  long verdict = 0;
  curl_easy_getinfo(curl, CURLINFO_SSL_VERIFYRESULT, &verdict);
  switch (verdict) {
    case kNotYetValid:
      return "the server's certificate is not yet valid: check the clock of this computer "
             "(timedatectl)";
    case kExpired:
      return "the server's certificate has expired: renew it on the server, or check the clock of "
             "this "
             "computer (timedatectl)";
    case kNoIssuer:
    case kSelfSigned:
    case kSelfSignedInChain:
    case kNoLocalIssuer:
    case kLeafNotVerified:
    case kUntrusted:
      return "the server's certificate is from an unknown authority: " + authorities;
    case 0:
    case 1:  // the name is checked before the chain
      return "the server's certificate has another name: check the configured host";
    default:
      return "the server's certificate is refused with OpenSSL error " + std::to_string(verdict) +
             " (see openssl verify)";
  }
}

std::string connect_trouble(CURL* curl) {
  long cause = 0;
  curl_easy_getinfo(curl, CURLINFO_OS_ERRNO, &cause);
  if (cause == ECONNREFUSED) return "connection refused: check that the server runs, and the port";
  if (cause == 0) return "no connection: check network, host and port";
  return std::string("no connection: ") + std::strerror(static_cast<int>(cause));
}

HttpOutcome handshake_trouble(const std::string& detail, const std::string& authorities) {
  if (has(detail, "wrong version number") || has(detail, "packet length too long")) {
    return failure(Kind::kRefused,
                   "TLS handshake failed: check the port, and that the server supports TLS");
  }
  if (has(detail, "alert")) {
    return failure(Kind::kRefused,
                   "the server refused the TLS handshake: no common version or cipher");
  }
  if (has(detail, " routines::")) {
    return failure(Kind::kRefused,
                   "the TLS handshake failed (" + one_line(detail, kDetailMax) +
                       "): check that the authority signed the server's certificate; " +
                       authorities);
  }
  return failure(
      Kind::kUnreachable,
      "the server closed the connection in the TLS handshake: check that it supports TLS, and the "
      "port");
}

constexpr double kConnectTimeout_s = 20;
constexpr std::size_t kReasonMax = 200;  // of a server message
constexpr std::size_t kHeaderBytesMax = 100'000;
constexpr int kAddressesMax = 4;  // tried per host
constexpr int kRedirectsMax = 5;

template <auto kFree>
struct Deleter {
  template <typename T>
  void operator()(T* held) const {
    kFree(held);
  }
};
using Handle = std::unique_ptr<CURL, Deleter<curl_easy_cleanup>>;
using List = std::unique_ptr<curl_slist, Deleter<curl_slist_free_all>>;
using Url = std::unique_ptr<CURLU, Deleter<curl_url_cleanup>>;
using Text = std::unique_ptr<char, Deleter<curl_free>>;

struct Received {
  std::string body;
  std::size_t bytes_max = 0;
  bool is_too_large = false;
  std::size_t header_bytes = 0;
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

/// Header of the answer itself, not of a proxy; empty: none.
std::string_view header(CURL* curl, const char* name) {
  curl_header* found = nullptr;
  const bool is_there = curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &found) == CURLHE_OK;
  return is_there ? found->value : "";
}

/// Called by libcurl at least once per second, also during waits.
int stop_when_requested(void* user, curl_off_t, curl_off_t, curl_off_t, curl_off_t) {
  return (*static_cast<const StopRequested*>(user))() ? 1 : 0;
}

using Clock = std::chrono::steady_clock;

double now_s() {
  return std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
}

/// Scheme, host and port of a URL.
struct Place {
  std::string scheme, host, port;
  friend bool operator==(const Place&, const Place&) = default;
  [[nodiscard]] std::string key() const { return host + ":" + port; }
};

Place place_of(const std::string& url) {
  const Url parsed(curl_url());
  const auto part = [&](CURLUPart what) -> std::string {
    char* text = nullptr;
    if (curl_url_get(parsed.get(), what, &text, CURLU_DEFAULT_PORT) != CURLUE_OK) return "";
    return Text(text).get();
  };
  if (curl_url_set(parsed.get(), CURLUPART_URL, url.c_str(), 0) != CURLUE_OK) return {};
  return {part(CURLUPART_SCHEME), part(CURLUPART_HOST), part(CURLUPART_PORT)};
}

/// Last working address of a host: a dual-stack host with one dead address costs one timeout in ten
/// minutes, not one per request. Then the resolver is asked again, because hosts move.
class ReachableAddresses {
 public:
  std::string find(const Place& place) {
    constexpr auto kValid = std::chrono::minutes(10);
    const std::lock_guard lock(mutex_);
    const auto found = addresses_.find(place.key());
    const bool is_valid = found != addresses_.end() && Clock::now() < found->second.since + kValid;
    return is_valid ? found->second.address : "";
  }
  void set(const Place& place, const std::string& address) {
    const std::lock_guard lock(mutex_);
    addresses_[place.key()] = {address, Clock::now()};
  }

 private:
  struct Entry {
    std::string address;
    Clock::time_point since;
  };
  std::mutex mutex_;
  std::map<std::string, Entry> addresses_;
};

ReachableAddresses& reachable_addresses() {
  static ReachableAddresses addresses;
  return addresses;
}

std::vector<std::string> addresses_of(const Place& place) {
  addrinfo wanted{};
  wanted.ai_socktype = SOCK_STREAM;
  addrinfo* found = nullptr;
  std::vector<std::string> addresses;
  if (getaddrinfo(place.host.c_str(), place.port.c_str(), &wanted, &found) != 0) return addresses;
  for (const addrinfo* a = found; a != nullptr && addresses.size() < kAddressesMax;
       a = a->ai_next) {
    char text[NI_MAXHOST];
    if (getnameinfo(a->ai_addr, a->ai_addrlen, text, sizeof text, nullptr, 0, NI_NUMERICHOST) == 0)
      addresses.emplace_back(text);
  }
  freeaddrinfo(found);
  return addresses;
}

/// Outcome of an incomplete transfer. `is_over`: the time of the request is used up.
HttpOutcome outcome_of_failure(CURL* curl, CURLcode code, const Received& received,
                               const HttpRequest& request, const char* error_text, bool is_over) {
  const HttpLimits& limits = request.limits;
  // libcurl reports a single header of 100 kB as out of memory.
  if (received.header_bytes > kHeaderBytesMax || code == CURLE_OUT_OF_MEMORY) {
    return failure(Kind::kRefused, formatted("the headers of the answer are larger than %zu bytes",
                                             kHeaderBytesMax));
  }
  if (received.is_too_large) {
    return failure(Kind::kRefused,
                   formatted("the answer exceeds the limit of %zu bytes", limits.bytes_max));
  }
  const bool has_begun = !received.body.empty();
  if (code == CURLE_OPERATION_TIMEDOUT && is_over) {
    const std::string waited = formatted("%g s", limits.deadline_s);
    return failure(Kind::kSlow,
                   has_begun ? "the answer was incomplete after " + waited + " (" +
                                   counted(received.body.size(), "byte") + ")"
                             : "no answer in time, " + waited + ": check the host and firewalls");
  }
  if (code == CURLE_OPERATION_TIMEDOUT && has_begun) {
    return failure(Kind::kSlow,
                   formatted("the answer was too slow, less than %ld bytes/s for %ld s",
                             limits.bytes_per_s_min, limits.slow_s));
  }
  const bool is_silent = code == CURLE_RECV_ERROR && received.header_bytes == 0;
  return transfer_trouble(curl, is_silent ? CURLE_GOT_NOTHING : code, error_text,
                          request.authorities);
}

/// libcurl detects truncated frames, chunks or lengths, but not truncation of an HTTP/1 body that
/// ends with its connection, or of a compressed text: then the end of the text is checked.
bool is_whole(CURL* curl, std::string_view body) {
  long version = 0;
  curl_off_t length = -1;
  curl_easy_getinfo(curl, CURLINFO_HTTP_VERSION, &version);
  curl_easy_getinfo(curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
  const bool is_framed = version >= CURL_HTTP_VERSION_2_0 || length >= 0 ||
                         header(curl, "Transfer-Encoding") == "chunked";
  const bool is_safe = is_framed && header(curl, "Content-Encoding").empty();
  if (!looks_like_json(body)) return body.ends_with('\n') || is_safe;
  // A truncated answer ends without a bracket.
  const bool is_closed = body.find_last_of("]}") != body.npos &&
                         body.find_last_of("]}") == body.find_last_not_of(" \t\r\n");
  return parse_answer(body).value().exists() || (is_safe && is_closed);
}

HttpOutcome outcome_of_status(CURL* curl, long status, bool is_post, Received received) {
  if (is_post && status / 100 == 2) return {Kind::kDone, std::move(received.body)};
  if (status == 200) {
    if (!is_whole(curl, received.body)) return failure(Kind::kTransient, "the answer is truncated");
    return {Kind::kDone, std::move(received.body)};
  }
  const std::string_view retry_after = header(curl, "Retry-After");
  const std::string wait_text(retry_after.empty() ? header(curl, "X-RateLimit-Reset")
                                                  : retry_after);
  const std::string body = one_line(received.body, kReasonMax);
  const std::string reason =
      formatted("the server answered %ld%s%s", status, body.empty() ? "" : ": ", body.c_str());
  if (status == 429 || status == 503) {
    return {Kind::kBusy, {}, reason, wait_seconds(wait_text, now_s())};
  }
  // 501 and 505 are permanent.
  const bool may_pass = status == 408 || (status >= 500 && status != 501 && status != 505);
  return failure(may_pass ? Kind::kTransient : Kind::kRefused, reason);
}

List header_list(const HttpRequest& request, const Place& origin, const std::string& url) {
  List list;
  const auto add = [&](const char* line) {
    if (curl_slist* const longer = curl_slist_append(list.get(), line)) {
      static_cast<void>(list.release());
      list.reset(longer);
    }
  };
  if (request.post) add("Content-Type: application/json");
  if (place_of(url) != origin) return list;
  for (const std::string& line : request.headers) add(line.c_str());
  return list;
}

/// One transfer of one URL, to an address, or one chosen by libcurl.
struct Transfer {
  const HttpRequest& request;
  const StopRequested& stop_requested;
  Clock::time_point deadline;
  Handle curl;
  const char* encoding = "";  ///< accepted encodings; "": all of libcurl

  [[nodiscard]] double left_s() const {
    return std::chrono::duration<double>(deadline - Clock::now()).count();
  }

  /// The connect timeout is a share of the remaining time, to leave time for other addresses.
  HttpOutcome perform(const std::string& url, const List& headers, const std::string& address,
                      double connect_share) {
    Received received;
    received.bytes_max = request.limits.bytes_max;
    char error_text[CURL_ERROR_SIZE] = "";
    const Place place = place_of(url);
    const bool is_ipv6 = address.find(':') != address.npos;
    const std::string entry = "+" + place.key() + ":" + (is_ipv6 ? "[" + address + "]" : address);
    const List resolve(address.empty() ? nullptr : curl_slist_append(nullptr, entry.c_str()));
    const double connect_s = std::min(kConnectTimeout_s, left_s() * connect_share);
    const auto ms = [](double s) { return std::max(static_cast<long>(1000 * s), 1L); };
    CURL* const c = curl.get();
    curl_easy_setopt(c, CURLOPT_URL, url.c_str());
    curl_easy_setopt(c, CURLOPT_PROTOCOLS_STR, "http,https");
    curl_easy_setopt(c, CURLOPT_RESOLVE, resolve.get());
    // A connection kept from the previous transfer leads to another address.
    curl_easy_setopt(c, CURLOPT_FRESH_CONNECT, address.empty() ? 0L : 1L);
    curl_easy_setopt(c, CURLOPT_HTTPHEADER, headers.get());
    if (request.post) curl_easy_setopt(c, CURLOPT_POSTFIELDS, request.post->c_str());
    // Like the curl command: a TLS-intercepting proxy has its own authority.
    const char* const authorities =
        request.ca_file.empty() ? std::getenv("SSL_CERT_FILE") : request.ca_file.c_str();
    if (authorities != nullptr) {
      curl_easy_setopt(c, CURLOPT_CAINFO, authorities);
      curl_easy_setopt(c, CURLOPT_CAPATH, nullptr);
    }
    curl_easy_setopt(c, CURLOPT_CONNECTTIMEOUT_MS, ms(connect_s));
    curl_easy_setopt(c, CURLOPT_TIMEOUT_MS, ms(left_s()));
    curl_easy_setopt(c, CURLOPT_LOW_SPEED_LIMIT, request.limits.bytes_per_s_min);
    curl_easy_setopt(c, CURLOPT_LOW_SPEED_TIME, request.limits.slow_s);
    curl_easy_setopt(c, CURLOPT_ACCEPT_ENCODING, encoding);
    curl_easy_setopt(c, CURLOPT_USERAGENT, request.user_agent.c_str());
    curl_easy_setopt(c, CURLOPT_NOSIGNAL, 1L);
    curl_easy_setopt(c, CURLOPT_ERRORBUFFER, error_text);
    curl_easy_setopt(c, CURLOPT_WRITEFUNCTION, take_body);
    curl_easy_setopt(c, CURLOPT_WRITEDATA, &received);
    curl_easy_setopt(c, CURLOPT_HEADERFUNCTION, take_header);
    curl_easy_setopt(c, CURLOPT_HEADERDATA, &received);
    curl_easy_setopt(c, CURLOPT_NOPROGRESS, 0L);
    curl_easy_setopt(c, CURLOPT_XFERINFOFUNCTION, stop_when_requested);
    curl_easy_setopt(c, CURLOPT_XFERINFODATA, &stop_requested);
    const CURLcode code = curl_easy_perform(c);
    curl_easy_setopt(c, CURLOPT_ERRORBUFFER, nullptr);
    curl_easy_setopt(c, CURLOPT_RESOLVE, nullptr);
    curl_easy_setopt(c, CURLOPT_HTTPHEADER, nullptr);
    HttpOutcome outcome;
    long status = 0;
    curl_easy_getinfo(c, CURLINFO_RESPONSE_CODE, &status);
    if (code != CURLE_OK) {
      const bool is_over = left_s() <= 0.05 * request.limits.deadline_s;
      outcome = outcome_of_failure(c, code, received, request, error_text, is_over);
    } else {
      outcome = outcome_of_status(c, status, request.post.has_value(), std::move(received));
    }
    outcome.transfer_code = code;
    outcome.status = code == CURLE_OK ? status : 0;
    return outcome;
  }

  [[nodiscard]] std::string address_used() const {
    const char* text = nullptr;
    curl_easy_getinfo(curl.get(), CURLINFO_PRIMARY_IP, &text);
    return text == nullptr ? "" : text;
  }
  /// Failures that may be limited to one address of the host: connection, TLS, reset, timeout,
  /// gateway errors.
  [[nodiscard]] bool may_be_the_address(const HttpOutcome& outcome) const {
    if (outcome.status == 502 || outcome.status == 504) return !stop_requested();
    switch (outcome.transfer_code) {
      case CURLE_OPERATION_TIMEDOUT:
      case CURLE_COULDNT_CONNECT:
      case CURLE_SSL_CONNECT_ERROR:
      case CURLE_PEER_FAILED_VERIFICATION:
      case CURLE_GOT_NOTHING:
      case CURLE_RECV_ERROR:
      case CURLE_SEND_ERROR:
      case CURLE_PARTIAL_FILE:
      case CURLE_HTTP2:
      case CURLE_HTTP2_STREAM:
        return !stop_requested();
      default:
        return false;
    }
  }

  /// Timed out before the name was resolved.
  [[nodiscard]] bool is_unresolved(const HttpOutcome& outcome) const {
    curl_off_t lookup_us = 0;
    curl_easy_getinfo(curl.get(), CURLINFO_NAMELOOKUP_TIME_T, &lookup_us);
    return outcome.transfer_code == CURLE_OPERATION_TIMEDOUT && lookup_us == 0;
  }

  /// Tries all addresses, the last working one first.
  HttpOutcome perform_at_addresses(const std::string& url, const List& headers) {
    constexpr double kFirstShare = 0.5;
    const Place place = place_of(url);
    const std::string known = reachable_addresses().find(place);
    HttpOutcome outcome = perform(url, headers, known, kFirstShare);
    // libcurl itself tries the next address after a refused connection.
    const bool has_tried_all = known.empty() && outcome.transfer_code == CURLE_COULDNT_CONNECT;
    if (has_tried_all || !may_be_the_address(outcome)) return outcome;
    if (known.empty() && is_unresolved(outcome)) {
      outcome.kind = Kind::kUnreachable;
      outcome.transfer_code = CURLE_COULDNT_RESOLVE_HOST;
      outcome.reason = "no name server answers: check the network and the resolver";
      return outcome;
    }
    const std::string failed = address_used();
    std::vector<std::string> others = addresses_of(place);
    const auto at = std::ranges::find(others, failed.empty() ? known : failed);
    // A proxy, or a host with one address, has no other.
    if (at == others.end() && !failed.empty()) return outcome;
    if (at != others.end()) {  // the addresses behind it first, so that each is tried in turn
      std::rotate(others.begin(), at + 1, others.end());
      others.pop_back();
    }
    for (std::size_t i = 0; i < others.size() && may_be_the_address(outcome); ++i) {
      // The next request begins with this address, even if no time is left now.
      reachable_addresses().set(place, others[i]);
      if (left_s() < 0.05) break;
      outcome = perform(url, headers, others[i], 1.0 / static_cast<double>(others.size() - i));
    }
    return outcome;
  }

  /// Target of a redirect; empty: none, or from https to http.
  [[nodiscard]] std::string redirect_target(const std::string& from) const {
    char* target = nullptr;
    curl_easy_getinfo(curl.get(), CURLINFO_REDIRECT_URL, &target);
    const std::string to = target == nullptr ? "" : target;
    const bool loses_tls = from.starts_with("https://") && !to.starts_with("https://");
    return loses_tls ? "" : to;
  }

  HttpOutcome follow() {
    const Place origin = place_of(request.url);
    std::string url = request.url;
    for (int i = 0;; ++i) {
      HttpOutcome outcome = perform_at_addresses(url, header_list(request, origin, url));
      const bool is_redirect = outcome.status / 100 == 3 && !request.post;
      const std::string target = is_redirect ? redirect_target(url) : "";
      if (is_redirect && target.empty()) {
        outcome.reason += "; it redirects to no https:// address: set the url to the final address";
      }
      if (target.empty()) return outcome;
      if (i == kRedirectsMax) {
        outcome.reason =
            formatted("more than %d redirects: set the url to the final address", kRedirectsMax);
        return outcome;
      }
      url = target;
    }
  }
};

Handle new_handle() {
  static const CURLcode started = curl_global_init(CURL_GLOBAL_DEFAULT);
  return Handle(started == CURLE_OK ? curl_easy_init() : nullptr);
}

}  // namespace

HttpOutcome transfer_trouble(void* curl, int code, const std::string& detail,
                             const std::string& authorities) {
  const std::string words = one_line(
      detail.empty() ? curl_easy_strerror(static_cast<CURLcode>(code)) : detail, kDetailMax);
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
      return failure(Kind::kUnreachable, "unknown host name: check the name and the resolver");
    case CURLE_COULDNT_CONNECT:
      return failure(Kind::kUnreachable, connect_trouble(curl));
    case CURLE_SSL_CONNECT_ERROR:
      return handshake_trouble(detail, authorities);
    case CURLE_PEER_FAILED_VERIFICATION:
      return failure(Kind::kRefused, certificate_trouble(curl, authorities));
    case CURLE_SSL_CACERT_BADFILE:
      return failure(Kind::kRefused,
                     "the certificates of authorities cannot be read: " + authorities);
    case CURLE_GOT_NOTHING:  // typical for TLS servers without TLS in the request
      return failure(
          Kind::kTransient,
          "the server closed the connection without an answer: check the port, and http:// or "
          "https://");
    case CURLE_OPERATION_TIMEDOUT:
      return failure(Kind::kTransient, "no answer in time: check the host and firewalls");
    case CURLE_PARTIAL_FILE:
    case CURLE_RECV_ERROR:
    case CURLE_SEND_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
    case CURLE_BAD_CONTENT_ENCODING:
      return failure(Kind::kTransient, words);
    case CURLE_ABORTED_BY_CALLBACK:
      return failure(Kind::kInterrupted, words);
    case CURLE_UNSUPPORTED_PROTOCOL:
      if (has(detail, "HTTP/0.9")) {
        return failure(Kind::kRefused, "the answer is not HTTP: use https:// instead of http://?");
      }
      return failure(Kind::kRefused, words);
    default:
      return failure(Kind::kRefused, words);
  }
}

HttpOutcome http_request(const HttpRequest& request, const StopRequested& stop_requested) {
  const auto budget = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(request.limits.deadline_s));
  Transfer transfer{request, stop_requested, Clock::now() + budget, new_handle()};
  if (transfer.curl == nullptr) return failure(Kind::kRefused, "libcurl cannot be started");
  HttpOutcome outcome = transfer.follow();
  // Repeats a request for a compressed text without final line end uncompressed, to check its
  // length.
  if (outcome.status == 200 && outcome.kind == Kind::kTransient &&
      !header(transfer.curl.get(), "Content-Encoding").empty()) {
    transfer.encoding = "identity";
    outcome = transfer.follow();
  }
  return outcome;
}

std::string url_encoded(const std::string& text) {
  const Text escaped(
      curl_easy_escape(new_handle().get(), text.data(), static_cast<int>(text.size())));
  return escaped == nullptr ? "" : escaped.get();
}

std::string describe_wait(double wait_s) {
  if (wait_s >= kWaitMax_s) return "a day or longer";
  return wait_s >= 120 ? formatted("%.0f minutes", wait_s / 60) : formatted("%.0f s", wait_s);
}

std::optional<double> wait_seconds(const std::string& header_value, double now_utc_s) {
  double number = 0;
  const char* end = header_value.data() + header_value.size();
  const auto [stop, error] = std::from_chars(header_value.data(), end, number);
  if (error == std::errc::result_out_of_range && stop == end) return kWaitMax_s;
  if (error == std::errc{} && stop == end && !std::isnan(number)) {
    constexpr double kSmallestTimestamp = 1e9;  // September 2001, too large for a duration
    return std::clamp(number < kSmallestTimestamp ? number : number - now_utc_s, 0.0, kWaitMax_s);
  }
  std::int64_t utc_s = 0;
  if (!parse_utc(header_value, utc_s, kAlsoBlank))
    utc_s = curl_getdate(header_value.c_str(), nullptr);
  if (utc_s <= 0) return std::nullopt;
  return std::clamp(static_cast<double>(utc_s) - now_utc_s, 0.0, kWaitMax_s);
}

}  // namespace bess
