// Why a transfer did not come to its end, in words that say what to look at, and what a caller does
// about it: the one table for every program. Nothing in it names the address, which may hold a
// secret.
#pragma once

#include <string>

#include "shared/host/http_client.h"

namespace bess {

struct TransferTrouble {
  HttpOutcome::Kind kind;
  std::string reason;  ///< one line
};

/// Of the CURLcode that a CURL* ended with, not CURLE_OK; `detail` is what libcurl had to say,
/// perhaps nothing; `authorities` as in HttpRequest.
TransferTrouble transfer_trouble(void* curl, int code, const std::string& detail,
                                 const std::string& authorities);

}  // namespace bess
