// Report page: page/report.html with style, scripts and data embedded.
#pragma once

#include <map>
#include <string>

#include "shared/host/json.h"

namespace bess {

/// Complete, self-contained document for light, dark, phone and print. `parts` replace the
/// {{placeholders}} of page/report.html, as HTML; `data` is for the scripts.
std::string format_report_page(const std::map<std::string, std::string>& parts, const Json& data);

/// Page of text and tables, with a list of `charts` for page/plain_charts.js.
std::string format_chart_page(std::string_view title, std::string body, Json charts);

/// Canvas of such a chart; `alt` describes it.
std::string chart_html(std::string_view id, std::string_view alt);

/// `template_text` with every {{name}} replaced by its part. Throws std::logic_error for a name
/// without a part.
std::string filled_in(std::string_view template_text,
                      const std::map<std::string, std::string>& parts);

/// JSON for a script element, without "<".
std::string script_safe(std::string json);

}  // namespace bess
