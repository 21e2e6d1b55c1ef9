#include "edge/prices/host_addresses.h"

#include <arpa/inet.h>
#include <curl/curl.h>
#include <netdb.h>

#include <cstdio>
#include <cstdlib>
#include <memory>

#include "shared/scaled_clock.h"

namespace bess {
namespace {

using Url = std::unique_ptr<CURLU, decltype(&curl_url_cleanup)>;

/// One part of a URL as fixed text; false when it is missing or too long.
template <int kCapacity>
bool copy_part(const Url& url, CURLUPart part, unsigned flags, FixedText<kCapacity>& text) {
  char* found = nullptr;
  if (curl_url_get(url.get(), part, &found, flags) != CURLUE_OK) return false;
  const bool fits = text.assign(found);
  curl_free(found);
  return fits;
}

bool is_numeric(const char* host) {
  in_addr address{};
  return host[0] == '[' || inet_pton(AF_INET, host, &address) == 1;
}

/// "192.0.2.1" or "[2001:db8::1]"; false for other families.
bool print_address(const addrinfo& found, char (&text)[INET6_ADDRSTRLEN + 2]) {
  char plain[INET6_ADDRSTRLEN];
  if (found.ai_family == AF_INET) {
    const auto* address = reinterpret_cast<const sockaddr_in*>(found.ai_addr);
    inet_ntop(AF_INET, &address->sin_addr, plain, sizeof plain);
    std::snprintf(text, sizeof text, "%s", plain);
    return true;
  }
  if (found.ai_family != AF_INET6) return false;
  const auto* address = reinterpret_cast<const sockaddr_in6*>(found.ai_addr);
  inet_ntop(AF_INET6, &address->sin6_addr, plain, sizeof plain);
  std::snprintf(text, sizeof text, "[%s]", plain);
  return true;
}

}  // namespace

void warm_up_resolver() {
  // Two name servers that are silent then cost 8 s a lookup instead of 20 s. The operator's own
  // wins.
  setenv("RES_OPTIONS", "timeout:2 attempts:2", 0);
  addrinfo* found = nullptr;
  if (getaddrinfo("warmup.invalid", nullptr, nullptr, &found) == 0) freeaddrinfo(found);
}

Status HostAddresses::set_url(const char* text) {
  const Url url(curl_url(), &curl_url_cleanup);
  if (url == nullptr) return Status::kNoMemory;
  if (curl_url_set(url.get(), CURLUPART_URL, text, 0) != CURLUE_OK) return Status::kMalformed;
  if (!copy_part(url, CURLUPART_HOST, 0, host_)) return Status::kMalformed;
  if (!copy_part(url, CURLUPART_PORT, CURLU_DEFAULT_PORT, port_)) return Status::kMalformed;
  is_name_ = !is_numeric(host_.c_str());
  entry_ = {};
  next_lookup_ns_ = 0;
  return Status::kOk;
}

bool HostAddresses::is_loopback() const {
  constexpr std::uint32_t kLoopbackNet = 127;
  in_addr v4{};
  if (inet_pton(AF_INET, host_.c_str(), &v4) == 1) return ntohl(v4.s_addr) >> 24 == kLoopbackNet;
  return host_.view() == "[::1]";  // as libcurl spells it, however it was written
}

bool HostAddresses::is_same_host(const HostAddresses& other) const {
  return host_.view() == other.host_.view() && port_.view() == other.port_.view();
}

Status HostAddresses::refresh(std::int64_t now_monotonic_ns, std::int32_t every_s) {
  if (!is_name_) return Status::kOk;
  if (now_monotonic_ns < next_lookup_ns_) return Status::kOk;
  const std::int32_t wait_s = look_up() ? every_s : kRetryS;
  if (entry_.empty()) return Status::kNameUnresolved;
  next_lookup_ns_ = now_monotonic_ns + wait_s * kNanosecondsPerSecond;
  return Status::kOk;
}

/// The old entry stays when nothing is found.
bool HostAddresses::look_up() {
  addrinfo hints{};
  hints.ai_family = AF_UNSPEC;
  hints.ai_socktype = SOCK_STREAM;  // else every address comes three times
  addrinfo* found = nullptr;
  if (getaddrinfo(host_.c_str(), nullptr, &hints, &found) != 0) return false;
  char entry[1024];
  auto size = static_cast<std::size_t>(
      std::snprintf(entry, sizeof entry, "%s:%s:", host_.c_str(), port_.c_str()));
  int addresses = 0;
  for (const addrinfo* item = found; item != nullptr; item = item->ai_next) {
    char address[INET6_ADDRSTRLEN + 2];
    if (!print_address(*item, address)) continue;
    const std::size_t left = sizeof entry - size;
    const int added = std::snprintf(entry + size, left, "%s%s", addresses > 0 ? "," : "", address);
    if (static_cast<std::size_t>(added) >= left) break;  // enough of them
    size += static_cast<std::size_t>(added);
    ++addresses;
  }
  freeaddrinfo(found);
  if (addresses > 0) entry_.assign(std::string_view(entry, size));
  return addresses > 0;
}

}  // namespace bess
