// Price settings as read from [price], [outlook] and related sections.
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
  std::int32_t timeout_ms = 5'000;  ///< one request with its redirects, wall time
};

/// Requests of a cycle, and the time over which they are distributed.
inline constexpr int kPriceRequests = 4;
inline constexpr std::int32_t kPriceWait_s = 20;
/// Time for all pages of the history; later pages are ignored.
inline constexpr std::int32_t kHistoryWait_s = 20;

struct PriceFeedSettings {
  HttpSettings http;
  PriceFields fields;
};

struct HistorySettings {
  std::int32_t hours = 72;  ///< 0 = none
  FixedText<511> url;       ///< source of rows older than the price URL has; empty = none
};

/// Meaning and remedy of a status of the price server.
constexpr std::string_view price_status_text(Status status) {
  switch (status) {
    case Status::kNotConnected:
      return "no connection, or lost (check host and port of url, and the network)";
    case Status::kTimeout:
      return "no complete answer in time (check the network, or request fewer rows in url)";
    case Status::kTooLarge:
      return "answer larger than 4 MB (request fewer rows in url)";
    case Status::kServerBusy:
      return "rate limited by the price server; retried when it permits";
    default:
      return status_text(status);
  }
}

// [outlook]: source of day-ahead prices.

/// energy-charts, for Belgium; {today} and {tomorrow} in a url are replaced by local dates.
inline HttpSettings usual_day_ahead_server() {
  HttpSettings http;
  http.url = "https://api.energy-charts.info/price?bzn=BE&start={today}&end={tomorrow}";
  http.timeout_ms = 10'000;
  return http;
}

struct OutlookSettings {
  HttpSettings http = usual_day_ahead_server();
  PriceFields fields{.rows = "", .time = "unix_seconds", .price = "price"};
  FixedText<639> file;            ///< an answer in the server's format; empty: the url is used
  std::int32_t ask_offset_s = 0;  ///< distributes the requests of many machines in time
};

}  // namespace bess
