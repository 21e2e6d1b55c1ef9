// Static files of the page, embedded into the program (page/page.cmake), so that a page is one
// self-contained file.
#pragma once

#include <string_view>

namespace bess {

/// Contents of report/page/`name`, of "chart.min.js" or "answers.schema.json". Throws
/// std::logic_error for another name.
std::string_view page_file(std::string_view name);

}  // namespace bess
