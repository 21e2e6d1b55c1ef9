// [outlook]: where day-ahead prices come from.
#pragma once

#include <cstdint>

#include "edge/prices/price_settings.h"

namespace bess {

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
