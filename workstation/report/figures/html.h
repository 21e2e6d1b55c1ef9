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

// Sortable table (page/sort.js): each cell has a text and a sort value. Narrow screens show rows as
// lists.

/// Text and sort value of a cell; unknown values come last.
struct Cell {
  std::string html;
  std::string sort{};
  bool is_text = false;  ///< left-aligned, may wrap
};

Cell text_cell(const std::string& text);
Cell no_text_cell();
/// NaN: empty.
Cell number_cell(const std::string& text, double value);
Cell number_cell(double value, int decimals);

struct SortTable {
  std::string id, caption;
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
};

/// Shows columns with a title.
SortTable sort_table(const std::string& id, const std::string& caption, const Table& table);
std::string sort_table_html(const SortTable& table);

/// Base style sheet of every page, shared/host/embed/document.css.
std::string style_sheet();

/// Complete, self-contained document for light, dark, phone and print.
std::string format_page(std::string_view title, std::string_view body);

}  // namespace bess
