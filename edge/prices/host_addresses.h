// The addresses of the host in a URL, asked of the system's resolver on the caller's thread and
// kept while the resolver is down. libcurl gets them ready made (CURLOPT_RESOLVE): left to itself
// it would start a thread for every name, after the seal. Part of http_client.
#pragma once

#include <cstdint>

#include "edge/base/status.h"
#include "shared/fixed_text.h"

namespace bess {

/// Loads what name lookups load at first use (modules, resolv.conf). Once, before the seal.
void warm_up_resolver();

class HostAddresses {
 public:
  static constexpr std::int32_t kRetryS = 60;  ///< after a failed lookup, while old ones are known

  /// kMalformed when `text` is no URL with a host.
  Status set_url(const char* text);
  /// False for numeric addresses: there is nothing to look up.
  [[nodiscard]] bool is_name() const { return is_name_; }
  /// True for the numbers of this machine itself, 127.0.0.0/8 and [::1].
  [[nodiscard]] bool is_loopback() const;
  [[nodiscard]] bool is_same_host(const HostAddresses& other) const;

  /// Looks the name up when its time has come; kNameUnresolved when no address is known at all.
  Status refresh(std::int64_t now_monotonic_ns, std::int32_t every_s);
  /// Asks again at the next `refresh`: nobody answered at these addresses.
  void expire() { next_lookup_ns_ = 0; }
  /// "host:port:address,[address]" for CURLOPT_RESOLVE; empty when there is none.
  [[nodiscard]] const char* entry() const { return entry_.c_str(); }

 private:
  bool look_up();

  FixedText<255> host_;
  FixedText<7> port_;
  FixedText<1023> entry_;
  std::int64_t next_lookup_ns_ = 0;
  bool is_name_ = false;
};

}  // namespace bess
