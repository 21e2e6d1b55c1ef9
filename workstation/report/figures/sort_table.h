// Sortable table (page/sort.js): each cell has a text and a sort value. Narrow screens show rows as
// lists.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/figures/html.h"

namespace bess {

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

}  // namespace bess
