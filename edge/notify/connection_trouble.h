// Why a server cannot be reached, by cause and with what to look at. None of it names the address,
// which may hold a secret.
#pragma once

#include <stop_token>
#include <string>

namespace bess {

/// Does what `curl`, a CURL*, is set up for. Empty when it was done; else why not. `authorities`
/// says where those are named whose certificates are believed. Ends within a second once it is
/// asked to stop.
std::string perform_transfer(void* curl, const std::string& authorities,
                             const std::stop_token& stop);

struct Place {
  std::string host;
  int port = 0;
  std::string ca_file;  ///< empty: no TLS
};

/// Connects, and goes: empty when host, port and certificate are as they should be. Waits ten
/// seconds at most.
std::string probe_connection(const Place& place, const std::string& authorities,
                             const std::stop_token& stop);

}  // namespace bess
