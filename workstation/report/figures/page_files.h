// The files of the page that are neither C++ nor made of results: embedded into the program by
// page/embed.cmake, so that a page is one file and needs nothing that is installed.
#pragma once

#include <string_view>

namespace bess {

/// Contents of report/page/`name`, of "chart.min.js" or "answers.schema.json". Throws
/// std::logic_error for another name.
std::string_view page_file(std::string_view name);

}  // namespace bess
