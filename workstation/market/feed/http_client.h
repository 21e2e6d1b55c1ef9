// One HTTP(S) GET with libcurl: TLS verified, proxies of the environment honoured, and the outcome
// sorted into what a caller does about it.
#pragma once

#include <atomic>
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
    kInterrupted,  ///< the user stopped it
  };
  Kind kind;
  std::string body;              ///< of kDone
  std::string reason;            ///< of the others, for the user
  std::optional<double> wait_s;  ///< what the server asked for
};

/// Returns soon after `interrupted` is raised, and as kTransient when the whole of it takes longer
/// than `deadline_s`; 0 = only silence ends it.
HttpOutcome http_get(const std::string& url, const std::atomic<bool>& interrupted,
                     double deadline_s = 0);

/// Where a redirect may lead: never from https to plain http.
const char* redirect_protocols(const std::string& url);

/// Percent-encoding of a query value.
std::string url_encoded(const std::string& text);

/// Seconds to wait by a Retry-After or X-RateLimit-Reset value: seconds, seconds since 1970, an ISO
/// time or an HTTP date; nothing when it is none of them. Never negative.
std::optional<double> wait_seconds(const std::string& header_value, double now_utc_s);

}  // namespace bess
