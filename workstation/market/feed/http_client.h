// One HTTP(S) GET with libcurl: TLS verified, proxies of the environment honoured, and the outcome
// sorted into what a caller does about it.
#pragma once

#include <atomic>
#include <cstddef>
#include <optional>
#include <string>

namespace bess {

struct HttpOutcome {
  enum class Kind {
    kDone,         ///< 200 and the whole body
    kBusy,         ///< 429 or 503: wait as told, or back off
    kTransient,    ///< 5xx, time-out, cut connection: worth another try
    kUnreachable,  ///< no such host, nobody listens: worth few tries
    kRefused,      ///< anything that another try cannot mend
    kSlow,         ///< it came, and too slowly: worth few tries
    kWrongClock,   ///< rows of the future: nobody's answer, a caller's finding
    kInterrupted,  ///< the user stopped it
  };
  Kind kind;
  std::string body;              ///< of kDone
  std::string reason;            ///< of the others, for the user
  std::optional<double> wait_s;  ///< what the server asked for
};

/// What an answer may cost.
struct HttpLimits {
  double deadline_s = 1'200;     ///< of the whole of it
  long bytes_per_s_min = 1'000;  ///< over `slow_s`: less is silence, or as bad
  long slow_s = 60;              ///< an export of a month is prepared for some seconds
  std::size_t bytes_max = std::size_t{512} << 20;  ///< of the body, unpacked
};

/// Returns soon after `interrupted` is raised, and at the latest as `limits` say: too slow or too
/// large is told as such.
HttpOutcome http_get(const std::string& url, const std::atomic<bool>& interrupted,
                     const HttpLimits& limits);

/// Where a redirect may lead: never from https to plain http.
const char* redirect_protocols(const std::string& url);

/// Percent-encoding of a query value.
std::string url_encoded(const std::string& text);

/// What a server may ask for at most: more is a mistake of its clock or of its numbers.
inline constexpr double kWaitMax_s = 86'400;

/// "7 s", "120 minutes", "a day or longer".
std::string describe_wait(double wait_s);

/// Seconds to wait by a Retry-After or X-RateLimit-Reset value: seconds, seconds since 1970, an ISO
/// time or an HTTP date; nothing when it is none of them. From 0 to kWaitMax_s.
std::optional<double> wait_seconds(const std::string& header_value, double now_utc_s);

}  // namespace bess
