// One answer of a price server, and how that ended in the edge's own terms.
#pragma once

#include <cstdint>
#include <string>

#include "edge/base/status.h"
#include "edge/prices/price_settings.h"
#include "shared/host/http_client.h"

namespace bess {

struct FetchResult {
  Status status = Status::kNotConnected;
  std::string body{};    ///< of kOk
  std::string reason{};  ///< of anything else, one line with the remedy
  double wait_s = 0;     ///< what the server asked for
};

/// A GET of `url` with the settings' secrets, authorities and, where it is less, time-out.
FetchResult fetch(const HttpSettings& settings, const std::string& url, std::int32_t timeout_ms,
                  const StopRequested& stop_requested);

}  // namespace bess
