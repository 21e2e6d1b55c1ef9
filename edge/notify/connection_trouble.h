// Why a broker cannot be reached, by cause and with what to look at.
#pragma once

#include <stop_token>
#include <string>

namespace bess {

struct Place {
  std::string host;
  int port = 0;
  std::string ca_file;  ///< empty: no TLS
};

/// Connects, and goes: empty when host, port and certificate are as they should be. Waits ten
/// seconds at most. `authorities` says where those are named whose certificates are believed.
std::string probe_connection(const Place& place, const std::string& authorities,
                             const std::stop_token& stop);

}  // namespace bess
