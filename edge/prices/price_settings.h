// [price] and the like, as read: whom bess-prices asks, and what the controller makes of it.
#pragma once

#include <cstdint>
#include <string_view>

#include "edge/base/status.h"
#include "edge/prices/price_row.h"
#include "shared/fixed_text.h"

namespace bess {

struct HttpSettings {
  FixedText<511> url;
  FixedText<255> ca_file = "/etc/ssl/certs/ca-certificates.crt";
  FixedText<2047> headers;          ///< lines of the header file; secret
  std::int32_t timeout_ms = 5'000;  ///< of one request with its redirects, wall time
};

struct PriceFeedSettings {
  HttpSettings http;
  PriceFields fields;
  std::int32_t requests_per_cycle = 4;
  std::int32_t wait_s = 20;  ///< over which the requests of a cycle are spread
  std::int32_t step_flag_centi_eur_per_mwh = 230'000;  ///< a larger step is flagged
  bool hold_flagged_step = true;                       ///< and held until the next row confirms it
};

struct HistorySettings {
  std::int32_t hours = 72;   ///< 0 = none
  std::int32_t wait_s = 20;  ///< for all pages together; then what there is must do
  FixedText<511> url;        ///< asked for what the price URL no longer has; empty = nothing
};

/// What a status means when it comes from the price server, and what mends it.
constexpr std::string_view price_status_text(Status status) {
  switch (status) {
    case Status::kNotConnected:
      return "no connection, or it was cut (are host and port of url right, is the network up?)";
    case Status::kTimeout:
      return "no complete answer in time (see timeout_ms)";
    default:
      return status_text(status);
  }
}

}  // namespace bess
