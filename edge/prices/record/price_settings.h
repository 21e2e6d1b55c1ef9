// [price] and the like, as read: whom bess-prices asks, and what the controller makes of it.
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/core/base/status.h"
#include "edge/prices/record/price_row.h"
#include "shared/fixed_text.h"

namespace bess {

struct HttpSettings {
  FixedText<511> url;
  FixedText<255> ca_file = "/etc/ssl/certs/ca-certificates.crt";
  FixedText<2047> headers;          ///< lines of the header file; secret
  std::int32_t timeout_ms = 5'000;  ///< of one request with its redirects, wall time
};

/// The requests of a cycle, and the time over which they are spread.
inline constexpr int kPriceRequests = 4;
inline constexpr std::int32_t kPriceWait_s = 20;
/// For all pages of the history together; then what has come must do.
inline constexpr std::int32_t kHistoryWait_s = 20;

struct PriceFeedSettings {
  HttpSettings http;
  PriceFields fields;
};

struct HistorySettings {
  std::int32_t hours = 72;  ///< 0 = none
  FixedText<511> url;       ///< asked for what the price URL no longer has; empty = nothing
};

/// What a status means when it comes from the price server, and what mends it.
constexpr std::string_view price_status_text(Status status) {
  switch (status) {
    case Status::kNotConnected:
      return "no connection, or it was cut (are host and port of url right, is the network up?)";
    case Status::kTimeout:
      return "no complete answer in time";
    default:
      return status_text(status);
  }
}

// [outlook]: where day-ahead prices come from.

/// energy-charts, of Belgium; {today} and {tomorrow} in a url stand for local dates.
inline HttpSettings usual_day_ahead_server() {
  HttpSettings http;
  http.url = "https://api.energy-charts.info/price?bzn=BE&start={today}&end={tomorrow}";
  http.timeout_ms = 10'000;
  return http;
}

struct OutlookSettings {
  HttpSettings http = usual_day_ahead_server();
  PriceFields fields{.rows = "", .time = "unix_seconds", .price = "price"};
  FixedText<639> file;            ///< with the answer of such a server; empty: the url is asked
  std::int32_t ask_offset_s = 0;  ///< so that many machines do not ask at one instant
};

}  // namespace bess
