// Why a transfer did not come to its end, in words that say what to look at, and what a caller does
// about it.
#pragma once

#include <string>

#include "workstation/market/feed/http_client.h"

namespace bess {

struct TransferTrouble {
  HttpOutcome::Kind kind;
  std::string reason;  ///< one line
};

/// Of a CURLcode; `detail` is what libcurl had to say, perhaps nothing.
TransferTrouble transfer_trouble(int code, const std::string& detail);

}  // namespace bess
