// Who may ask. A page on the loopback device is within reach of every browser on that machine, and
// so of every web site that it visits: the name that is asked for must be ours (no rebinding of a
// foreign name).
#pragma once

#include <string_view>

#include "edge/page/page_settings.h"

namespace bess {

/// `host` of the request, with or without a port: this server's address, localhost on loopback, or
/// one of `hosts`.
bool is_our_host(std::string_view host, const PageSettings& settings);

}  // namespace bess
