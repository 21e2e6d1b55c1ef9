// Replacement of the C library's name lookup in a test program (fake_resolver.cpp defines
// getaddrinfo, also for libcurl): the test sets the addresses of a name.
#pragma once

#include <string>
#include <vector>

namespace bess::fake_resolver {

/// Sets the numeric addresses of `name`; none = it cannot be resolved.
void set(const std::string& name, const std::vector<std::string>& addresses);

}  // namespace bess::fake_resolver
