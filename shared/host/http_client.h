// One HTTP(S) request with libcurl, for every program that may use the heap: HTTP/2 and all
// encodings that libcurl has, proxies of the environment, TLS verified, every address of the host
// in turn, bounded in time, bytes and redirects. The outcome is sorted into what a caller does
// about it.
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
    kDone,         ///< 200 (of a post: 2xx) and the whole body
    kBusy,         ///< 429 or 503: wait as told, or back off
    kTransient,    ///< 5xx, time-out, cut connection: worth another try
    kUnreachable,  ///< no such host, nobody listens: worth few tries
    kRefused,      ///< anything that another try cannot mend
    kSlow,         ///< it came, and too slowly: worth few tries
    kInterrupted,  ///< the caller stopped it
  };
  Kind kind = Kind::kRefused;
  std::string body = {};              ///< of kDone
  std::string reason = {};            ///< of the others, one line with the remedy
  std::optional<double> wait_s = {};  ///< what the server asked for
  int transfer_code = 0;              ///< libcurl's CURLcode
  long status = 0;                    ///< HTTP status; 0: there was no answer
};

/// What an answer may cost.
struct HttpLimits {
  double deadline_s = 1'200;     ///< of the whole of it
  long bytes_per_s_min = 1'000;  ///< over `slow_s`: less is silence, or as bad
  long slow_s = 60;              ///< an export of a month is prepared for some seconds
  std::size_t bytes_max = std::size_t{512} << 20;  ///< of the body, unpacked
};

struct HttpRequest {
  std::string url;
  HttpLimits limits{};
  std::string user_agent = "bess";
  /// "Name: value"; secret: never sent to another host than the URL's, or on from https to http.
  std::vector<std::string> headers{};
  std::string ca_file{};  ///< of trusted authorities; empty: SSL_CERT_FILE, or the system's
  /// In messages: how another file of authorities is named.
  std::string authorities = "SSL_CERT_FILE may name a file of others";
  std::optional<std::string> post{};  ///< a body to post; its redirects are not followed
  int redirects_max = 5;              ///< never from https to http
};

/// Asked at least once a second.
using StopRequested = std::function<bool()>;

/// Returns soon after a stop is requested, and at the latest as the limits say.
HttpOutcome http_request(const HttpRequest& request, const StopRequested& stop_requested);

/// Percent-encoding of a query value.
std::string url_encoded(const std::string& text);

/// What a server may ask for at most: more is a mistake of its clock or of its numbers.
inline constexpr double kWaitMax_s = kSecondsPerDay;

/// "7 s", "120 minutes", "a day or longer".
std::string describe_wait(double wait_s);

/// Seconds to wait by a Retry-After or X-RateLimit-Reset value: seconds, seconds since 1970, an ISO
/// time or an HTTP date; nothing when it is none of them. From 0 to kWaitMax_s.
std::optional<double> wait_seconds(const std::string& header_value, double now_utc_s);

// Why a transfer did not come to its end, in words that say what to look at, and what a caller does
// about it: the one table for every program. Nothing in it names the address, which may hold a
// secret.

struct TransferTrouble {
  HttpOutcome::Kind kind;
  std::string reason;  ///< one line
};

/// Of the CURLcode that a CURL* ended with, not CURLE_OK; `detail` is what libcurl had to say,
/// perhaps nothing; `authorities` as in HttpRequest.
TransferTrouble transfer_trouble(void* curl, int code, const std::string& detail,
                                 const std::string& authorities);

}  // namespace bess
