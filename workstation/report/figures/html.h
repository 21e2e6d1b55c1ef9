// The page around the figures: the style sheet, the tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/text.h"
#include "workstation/base/table.h"

namespace bess {

/// What a cell shows that has nothing to say.
inline constexpr const char* kNoValue = "\u2013";

/// A table whose first column names the row and whose other columns are numbers. Each number bears
/// the head of its column: a narrow screen shows every row as a list.
struct HtmlTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
  std::vector<std::string> links{};  ///< of the first cells; none, or one a row
};
std::string format_table(const HtmlTable& table);
/// The columns that have a title.
std::string format_table(const std::string& caption, const Table& table);

/// Base style sheet of every page, shared/host/made/document.css.
std::string style_sheet();

/// A complete document: light and dark, phone and print, nothing fetched from outside.
std::string format_page(std::string_view title, std::string_view body);

}  // namespace bess
