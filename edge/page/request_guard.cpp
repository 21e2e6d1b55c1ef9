#include "edge/page/request_guard.h"

#include "edge/companion/numeric_address.h"

namespace bess {
namespace {

/// Without its port; of "[::1]:80" what stands in the brackets.
std::string_view without_port(std::string_view host) {
  if (host.starts_with('[')) {
    const std::size_t end = host.find(']');
    return end == host.npos ? std::string_view() : host.substr(1, end - 1);
  }
  return host.substr(0, host.rfind(':'));
}

bool equals_ignoring_case(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
    if (lower(a[i]) != lower(b[i])) return false;
  }
  return true;
}

}  // namespace

bool is_our_host(std::string_view host, const PageSettings& settings) {
  const std::string_view name = without_port(host);
  if (name.empty()) return false;
  if (name == settings.host) return true;
  if (is_loopback_address(settings.host) && equals_ignoring_case(name, "localhost")) return true;
  for (const std::string& ours : settings.hosts) {
    if (equals_ignoring_case(name, ours)) return true;
  }
  // Listening everywhere: any address is one of ours, but no name that is not in `hosts`.
  return (settings.host == "0.0.0.0" || settings.host == "::") &&
         is_numeric_address(std::string(name));
}

}  // namespace bess
