// Stands in for the C library's name lookup in a test program (fake_resolver.cpp defines
// getaddrinfo, which libcurl would call as well): the test says what a name means.
#pragma once

#include <string>
#include <vector>

namespace bess::fake_resolver {

/// From now on `name` has these numeric addresses; none = it cannot be resolved.
void set(const std::string& name, const std::vector<std::string>& addresses);

}  // namespace bess::fake_resolver
