// What of an HTTP request is secret: the header file, and parts of URLs. Nothing of it is ever
// logged. Start-up only: read by edge_config, shown by startup.
#pragma once

#include <string>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

/// Reads lines "Name: value" that are sent with every request; '#' starts a comment. False with one
/// line that never holds the content.
bool load_http_headers(const char* path, FixedText<2047>& headers, std::string& error);

/// A URL as it may be logged: without user and password, and with "..." for the values of query
/// keys that sound like secrets.
FixedText<511> loggable_url(std::string_view url);

}  // namespace bess
