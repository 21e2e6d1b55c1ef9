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

constexpr std::size_t kDetailMax = 200;  // of a library's own words in a message

/// OpenSSL's verdicts on a certificate (x509_vfy.h), as libcurl hands them on.
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

bool has(const std::string& text, const char* part) { return text.find(part) != text.npos; }

std::string certificate_trouble(CURL* curl, const std::string& authorities) {
  long verdict = 0;
  curl_easy_getinfo(curl, CURLINFO_SSL_VERIFYRESULT, &verdict);
  switch (verdict) {
    case kNotYetValid:
      return "the server's certificate is not valid yet: is this computer's clock right "
             "(timedatectl)?";
    case kExpired:
      return "the server's certificate has expired: renew it there; or is this computer's clock "
             "wrong (timedatectl)?";
    case kNoIssuer:
    case kSelfSigned:
    case kSelfSignedInChain:
    case kNoLocalIssuer:
    case kLeafNotVerified:
    case kUntrusted:
      return "the server's certificate is of no authority that is known here: " + authorities;
    case 0:
    case 1:  // the chain was not even asked for: the name comes first
      return "the server's certificate is of another name: is it the host that is configured?";
    default:
      return "the server's certificate is refused, OpenSSL's verdict " + std::to_string(verdict) +
             " (openssl verify knows it)";
  }
}

std::string connect_trouble(CURL* curl) {
  long cause = 0;
  curl_easy_getinfo(curl, CURLINFO_OS_ERRNO, &cause);
  if (cause == ECONNREFUSED) return "connection refused: does the server run, is the port right?";
  if (cause == 0) return "no connection: is the network up, do host and port answer?";
  return std::string("no connection: ") + std::strerror(static_cast<int>(cause));
}

TransferTrouble handshake_trouble(const std::string& detail, const std::string& authorities) {
  if (has(detail, "wrong version number") || has(detail, "packet length too long")) {
    return {Kind::kRefused, "no TLS there: is the port right, does the server speak TLS?"};
  }
  if (has(detail, "alert")) {
    return {Kind::kRefused,
            "the server refused the TLS handshake: it knows no common version or cipher"};
  }
  if (has(detail, " routines::")) {
    return {Kind::kRefused,
            "the TLS handshake failed (" + one_line(detail, kDetailMax) +
                "): is the authority the one that signed the server's certificate? " + authorities};
  }
  return {Kind::kUnreachable,
          "the server closed the connection in the TLS handshake: is there no TLS there, is the "
          "port right?"};
}

}  // namespace

TransferTrouble transfer_trouble(void* curl, int code, const std::string& detail,
                                 const std::string& authorities) {
  const std::string words = one_line(
      detail.empty() ? curl_easy_strerror(static_cast<CURLcode>(code)) : detail, kDetailMax);
  switch (code) {
    case CURLE_COULDNT_RESOLVE_HOST:
    case CURLE_COULDNT_RESOLVE_PROXY:
      return {Kind::kUnreachable,
              "the host's name is not known: is it right, does the resolver answer?"};
    case CURLE_COULDNT_CONNECT:
      return {Kind::kUnreachable, connect_trouble(curl)};
    case CURLE_SSL_CONNECT_ERROR:
      return handshake_trouble(detail, authorities);
    case CURLE_PEER_FAILED_VERIFICATION:
      return {Kind::kRefused, certificate_trouble(curl, authorities)};
    case CURLE_SSL_CACERT_BADFILE:
      return {Kind::kRefused, "the certificates of authorities cannot be read: " + authorities};
    case CURLE_GOT_NOTHING:  // as servers of TLS do that are asked without
      return {
          Kind::kTransient,
          "the server closed the connection without an answer: are port and http:// or https:// "
          "right?"};
    case CURLE_OPERATION_TIMEDOUT:
      return {Kind::kTransient, "no answer in time: is the host up, does a firewall swallow it?"};
    case CURLE_PARTIAL_FILE:
    case CURLE_RECV_ERROR:
    case CURLE_SEND_ERROR:
    case CURLE_HTTP2:
    case CURLE_HTTP2_STREAM:
    case CURLE_BAD_CONTENT_ENCODING:
      return {Kind::kTransient, words};
    case CURLE_ABORTED_BY_CALLBACK:
      return {Kind::kInterrupted, words};
    case CURLE_UNSUPPORTED_PROTOCOL:
      if (has(detail, "HTTP/0.9")) {
        return {Kind::kRefused, "the answer is no HTTP: is it https:// instead of http://?"};
      }
      return {Kind::kRefused, words};
    default:
      return {Kind::kRefused, words};
  }
}

namespace {

using Kind = HttpOutcome::Kind;

constexpr double kConnectTimeout_s = 20;
constexpr std::size_t kReasonMax = 200;  // of a server's own words in a message
constexpr std::size_t kHeaderBytesMax = 100'000;
constexpr int kAddressesMax = 4;  // of a host, that are tried

template <auto kFree>
struct FreeWith {
  template <typename T>
  void operator()(T* held) const {
    kFree(held);
  }
};
using Handle = std::unique_ptr<CURL, FreeWith<curl_easy_cleanup>>;
using List = std::unique_ptr<curl_slist, FreeWith<curl_slist_free_all>>;
using Url = std::unique_ptr<CURLU, FreeWith<curl_url_cleanup>>;
using Text = std::unique_ptr<char, FreeWith<curl_free>>;

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

/// Of the answer itself, not of a proxy; empty when it has none of that name.
std::string_view header(CURL* curl, const char* name) {
  curl_header* found = nullptr;
  const bool is_there = curl_easy_header(curl, name, 0, CURLH_HEADER, -1, &found) == CURLHE_OK;
  return is_there ? found->value : "";
}

/// libcurl calls it at least once a second, also while it waits.
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

/// Which address of a host answered last: a dual-stack host whose one side is dead costs one
/// time-out, not one a request.
class GoodAddresses {
 public:
  std::string find(const Place& place) {
    const std::lock_guard lock(mutex_);
    const auto found = addresses_.find(place.key());
    return found == addresses_.end() ? "" : found->second;
  }
  void set(const Place& place, const std::string& address) {
    const std::lock_guard lock(mutex_);
    addresses_[place.key()] = address;
  }

 private:
  std::mutex mutex_;
  std::map<std::string, std::string> addresses_;
};

GoodAddresses& good_addresses() {
  static GoodAddresses addresses;
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

/// Of a transfer that did not come to its end.
HttpOutcome outcome_of_failure(CURL* curl, CURLcode code, const Received& received,
                               const HttpRequest& request, const char* error_text) {
  const HttpLimits& limits = request.limits;
  double took_s = 0;
  curl_easy_getinfo(curl, CURLINFO_TOTAL_TIME, &took_s);
  // libcurl itself ends a single header of 100 kB, by saying that memory is short.
  if (received.header_bytes > kHeaderBytesMax || code == CURLE_OUT_OF_MEMORY) {
    return {Kind::kRefused,
            {},
            formatted("the answer's headers have no end: more than %zu bytes of them are none",
                      kHeaderBytesMax)};
  }
  if (received.is_too_large) {
    return {Kind::kRefused,
            {},
            formatted("the answer is larger than %zu bytes, more than is meant here",
                      limits.bytes_max)};
  }
  const bool has_begun = !received.body.empty();
  if (code == CURLE_OPERATION_TIMEDOUT && took_s >= 0.95 * limits.deadline_s) {
    const std::string waited = formatted("%g s", limits.deadline_s);
    return {Kind::kSlow,
            {},
            has_begun ? "the answer was not whole after " + waited + " (" +
                            counted(received.body.size(), "byte") + ")"
                      : "no answer in time, " + waited + ": is the host up, a firewall silent?"};
  }
  if (code == CURLE_OPERATION_TIMEDOUT && has_begun) {
    return {Kind::kSlow,
            {},
            formatted("the answer came too slowly, less than %ld bytes a second for %ld s",
                      limits.bytes_per_s_min, limits.slow_s)};
  }
  const bool is_silent = code == CURLE_RECV_ERROR && received.header_bytes == 0;
  TransferTrouble trouble =
      transfer_trouble(curl, is_silent ? CURLE_GOT_NOTHING : code, error_text, request.authorities);
  return {trouble.kind, {}, std::move(trouble.reason)};
}

/// libcurl reports a body that ends before its frames, chunks or length do. It cannot where an
/// HTTP/1 connection's end is the body's, and says nothing of a packed text that breaks off: then
/// the text must end as a whole one does.
bool is_whole(CURL* curl, std::string_view body) {
  long version = 0;
  curl_off_t length = -1;
  curl_easy_getinfo(curl, CURLINFO_HTTP_VERSION, &version);
  curl_easy_getinfo(curl, CURLINFO_CONTENT_LENGTH_DOWNLOAD_T, &length);
  const bool is_framed = version >= CURL_HTTP_VERSION_2_0 || length >= 0 ||
                         header(curl, "Transfer-Encoding") == "chunked";
  const bool is_safe = is_framed && header(curl, "Content-Encoding").empty();
  if (!looks_like_json(body)) return body.ends_with('\n') || is_safe;
  // Not all that servers write, such as NaN, is JSON; half of an answer ends otherwise.
  const bool is_closed = body.find_last_of("]}") != body.npos &&
                         body.find_last_of("]}") == body.find_last_not_of(" \t\r\n");
  return Json::parse(body).value().exists() || (is_safe && is_closed);
}

HttpOutcome outcome_of_status(CURL* curl, long status, bool is_post, Received received) {
  if (is_post && status / 100 == 2) return {Kind::kDone, std::move(received.body)};
  if (status == 200) {
    if (!is_whole(curl, received.body)) {
      return {Kind::kTransient, {}, "the answer was cut short"};
    }
    return {Kind::kDone, std::move(received.body)};
  }
  const std::string_view retry_after = header(curl, "Retry-After");
  const std::string told(retry_after.empty() ? header(curl, "X-RateLimit-Reset") : retry_after);
  const std::string body = one_line(received.body, kReasonMax);
  const std::string reason =
      formatted("the server answered %ld%s%s", status, body.empty() ? "" : ": ", body.c_str());
  if (status == 429 || status == 503) {
    return {Kind::kBusy, {}, reason, wait_seconds(told, now_s())};
  }
  // 501 and 505: the server cannot do what is asked, now or later.
  const bool may_pass = status == 408 || (status >= 500 && status != 501 && status != 505);
  return {may_pass ? Kind::kTransient : Kind::kRefused, {}, reason};
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

/// One transfer of one URL, to an address, or as libcurl finds one.
struct Transfer {
  const HttpRequest& request;
  const StopRequested& stop_requested;
  Clock::time_point deadline;
  Handle curl;
  const char* encoding = "";  ///< what may be sent and unpacked; "" = all that libcurl can

  [[nodiscard]] double left_s() const {
    return std::chrono::duration<double>(deadline - Clock::now()).count();
  }

  /// The time to connect is a share of what is left, so that another address has its turn.
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
    curl_easy_setopt(c, CURLOPT_HTTPHEADER, headers.get());
    if (request.post) curl_easy_setopt(c, CURLOPT_POSTFIELDS, request.post->c_str());
    // As the curl command does: a proxy that opens TLS has an authority of its own.
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
      outcome = outcome_of_failure(c, code, received, request, error_text);
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
  /// Failures that another address of the host may not have: connection, TLS, reset, time-out, a
  /// gateway with nothing behind it.
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

  /// At every address in turn, the one that answered last first.
  HttpOutcome perform_at_addresses(const std::string& url, const List& headers) {
    constexpr double kFirstShare = 0.5;
    const Place place = place_of(url);
    const std::string known = good_addresses().find(place);
    HttpOutcome outcome = perform(url, headers, known, kFirstShare);
    // libcurl itself tries the next address where nobody takes a connection.
    const bool has_tried_all = known.empty() && outcome.transfer_code == CURLE_COULDNT_CONNECT;
    if (has_tried_all || !may_be_the_address(outcome)) return outcome;
    const std::string failed = address_used();
    std::vector<std::string> others = addresses_of(place);
    const auto end = std::remove(others.begin(), others.end(), failed.empty() ? known : failed);
    // Of a proxy, or of a host with one address, there is no other.
    if (end == others.end() && !failed.empty()) return outcome;
    others.erase(end, others.end());
    for (std::size_t i = 0; i < others.size() && may_be_the_address(outcome); ++i) {
      // The next request begins with another address, also where no time is left for it in this.
      good_addresses().set(place, others[i]);
      if (left_s() < 0.05) break;
      outcome = perform(url, headers, others[i], 1.0 / static_cast<double>(others.size() - i));
    }
    return outcome;
  }

  /// Where the answer leads; empty: nowhere, or not from https to http.
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
      if (target.empty()) return outcome;
      if (i == request.redirects_max) {
        outcome.reason = formatted("more than %d redirects", request.redirects_max);
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

HttpOutcome http_request(const HttpRequest& request, const StopRequested& stop_requested) {
  const auto budget = std::chrono::duration_cast<Clock::duration>(
      std::chrono::duration<double>(request.limits.deadline_s));
  Transfer transfer{request, stop_requested, Clock::now() + budget, new_handle()};
  if (transfer.curl == nullptr) return {Kind::kRefused, {}, "libcurl cannot be started"};
  HttpOutcome outcome = transfer.follow();
  // A packed text without a last line end is asked for once more, plain: then its length tells.
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
    constexpr double kSmallestTimestamp = 1e9;  // September 2001; nobody is told to wait so long
    return std::clamp(number < kSmallestTimestamp ? number : number - now_utc_s, 0.0, kWaitMax_s);
  }
  std::int64_t utc_s = 0;
  if (!parse_utc(header_value, utc_s, kAlsoBlank))
    utc_s = curl_getdate(header_value.c_str(), nullptr);
  if (utc_s <= 0) return std::nullopt;
  return std::clamp(static_cast<double>(utc_s) - now_utc_s, 0.0, kWaitMax_s);
}

}  // namespace bess
