// HTTP(S) request with libcurl, for programs that may use the heap: HTTP/2, all encodings of
// libcurl, proxies of the environment, verified TLS, all addresses of the host, with limits of
// time, bytes and redirects. Outcomes are classified by the reaction of the caller.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "shared/units_and_limits.h"

namespace bess {

struct HttpOutcome {
  enum class Kind {
    kDone,         ///< 200 (post: 2xx) and the complete body
    kBusy,         ///< 429 or 503: wait as requested, or back off
    kTransient,    ///< 5xx, timeout, cut connection: retry
    kUnreachable,  ///< unknown host, connection refused: few retries
    kRefused,      ///< permanent: no retry
    kSlow,         ///< too slow: few retries
    kInterrupted,  ///< stopped by the caller
  };
  Kind kind = Kind::kRefused;
  std::string body = {};              ///< of kDone
  std::string reason = {};            ///< of the others, one line with the remedy
  std::optional<double> wait_s = {};  ///< requested by the server
  int transfer_code = 0;              ///< libcurl's CURLcode
  long status = 0;                    ///< HTTP status; 0: no answer
};

/// Limits of an answer.
struct HttpLimits {
  double deadline_s = 1'200;     ///< of the whole request
  long bytes_per_s_min = 1'000;  ///< minimum over `slow_s`
  long slow_s = 60;              ///< preparing an export of a month takes some seconds
  std::size_t bytes_max = std::size_t{512} << 20;  ///< of the body, unpacked
};

/// Redirects are followed, but never from https to http.
struct HttpRequest {
  std::string url;
  HttpLimits limits{};
  std::string user_agent = "bess";
  /// "Name: value"; secret: sent only to the host of the URL, never from https to http.
  std::vector<std::string> headers{};
  std::string ca_file{};  ///< trusted authorities; empty: SSL_CERT_FILE, or those of the system
  /// In messages: how to set another file of authorities.
  std::string authorities = "SSL_CERT_FILE can name a file of other authorities";
  std::optional<std::string> post{};  ///< a body to post; its redirects are not followed
};

/// Called at least once per second.
using StopRequested = std::function<bool()>;

/// Returns soon after a stop request, at the latest at the limits.
HttpOutcome http_request(const HttpRequest& request, const StopRequested& stop_requested);

/// Percent-encoding of a query value.
std::string url_encoded(const std::string& text);

/// Maximum wait requested by a server; longer ones are errors of the server.
inline constexpr double kWaitMax_s = kSecondsPerDay;

/// "7 s", "120 minutes", "a day or longer".
std::string describe_wait(double wait_s);

/// Seconds to wait by a Retry-After or X-RateLimit-Reset value: seconds, seconds since 1970, an ISO
/// time or an HTTP date; empty: none of them. From 0 to kWaitMax_s.
std::optional<double> wait_seconds(const std::string& header_value, double now_utc_s);

// Causes of incomplete transfers, with remedy and reaction of the caller: one table for all
// programs. Messages never contain the address, which may be secret.

/// Kind and reason for a CURLcode other than CURLE_OK of a CURL*; `detail`: message of libcurl, may
/// be empty; `authorities` as in HttpRequest.
HttpOutcome transfer_trouble(void* curl, int code, const std::string& detail,
                             const std::string& authorities);

}  // namespace bess
