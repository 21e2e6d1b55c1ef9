// The style sheet and the script of the page, embedded when it is built.
#pragma once

#include <string_view>

namespace bess {

/// "page.css" or "page.js".
std::string_view page_file(std::string_view name);

}  // namespace bess
