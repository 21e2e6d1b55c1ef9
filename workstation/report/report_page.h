// The page of a report, put together: page/report.html with its style, its scripts and its data
// inside.
#pragma once

#include <map>
#include <string>

#include "shared/host/json.h"

namespace bess {

/// Complete document: light and dark, phone and print, nothing fetched from outside. `parts` fill
/// the
/// {{placeholders}} of page/report.html by name, as HTML; `data` is for the scripts.
std::string format_report_page(const std::map<std::string, std::string>& parts, const Json& data);

/// A page of text and tables whose charts page/plain_charts.js draws from `charts`, a list.
std::string format_chart_page(std::string_view title, std::string body, Json charts);

/// Where such a chart stands; `alt` tells what is to be seen.
std::string chart_html(std::string_view id, std::string_view alt);

/// `template_text` with every {{name}} replaced by its part. Throws std::logic_error for a name
/// without a part.
std::string filled_in(std::string_view template_text,
                      const std::map<std::string, std::string>& parts);

/// JSON that may stand inside a script element: no "<" in it.
std::string script_safe(std::string json);

}  // namespace bess
