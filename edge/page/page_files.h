// The static files of the page, embedded when it is built.
#pragma once

#include <string_view>

namespace bess {

/// "page.html", "page.css", "page.js" or "chart.min.js".
std::string_view page_file(std::string_view name);

}  // namespace bess
