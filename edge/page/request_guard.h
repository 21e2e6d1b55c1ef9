// Who may ask, and who may order. A page on the loopback device is within reach of every browser on
// that machine, and so of every web site that it visits: the name that is asked for must be ours
// (no rebinding of a foreign name), an order must come from our own page and bring a token, which
// no browser adds by itself, and guessing it is slow.
#pragma once

#include <cstdint>
#include <mutex>
#include <string_view>

#include "edge/page/page_settings.h"

namespace bess {

/// `host` of the request, with or without a port: this server's address, localhost on loopback, or
/// one of `hosts`.
bool is_our_host(std::string_view host, const PageSettings& settings);

/// `origin` of an order: none (no browser), or a page of one of our names.
bool is_our_origin(std::string_view origin, const PageSettings& settings);

/// At most five wrong tokens in a minute, from whomever.
class WrongTokens {
 public:
  static constexpr int kMax = 5;
  [[nodiscard]] bool are_too_many(std::int64_t monotonic_ns);
  void count(std::int64_t monotonic_ns);

 private:
  std::mutex lock_;
  std::int64_t minute_ends_ns_ = 0;
  int count_ = 0;
};

}  // namespace bess
