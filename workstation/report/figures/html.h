// HTML pages: style sheet and tables.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "shared/host/text.h"
#include "workstation/base/table.h"

namespace bess {

/// Text of an empty cell.
inline constexpr const char* kNoValue = "\u2013";

/// Table with row names in the first column and numbers in the others. Numbers carry their column
/// head, because narrow screens show rows as lists.
struct HtmlTable {
  std::string caption;
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
std::string format_table(const HtmlTable& table);
/// Shows columns with a title.
std::string format_table(const std::string& caption, const Table& table);

/// Base style sheet of every page, shared/host/embed/document.css.
std::string style_sheet();

/// Complete, self-contained document for light, dark, phone and print.
std::string format_page(std::string_view title, std::string_view body);

}  // namespace bess
