// A table that sorts by its heads (page/sort.js): each cell is what it shows and what it is sorted
// by. On a narrow screen every row is a list.
#pragma once

#include <string>
#include <vector>

#include "workstation/report/figures/html.h"

namespace bess {

/// What a cell shows, and what it is sorted by; what is not known comes last.
struct Cell {
  std::string html;
  std::string sort{};
  bool is_text = false;  ///< read from the left, and may be broken
};

Cell text_cell(const std::string& text);
Cell no_text_cell();
/// NaN: nothing.
Cell number_cell(const std::string& text, double value);
Cell number_cell(double value, int decimals);

struct SortTable {
  std::string id, caption;
  std::vector<std::string> header;
  std::vector<std::vector<Cell>> rows;
};

/// The columns that have a title.
SortTable sort_table(const std::string& id, const std::string& caption, const Table& table);
std::string sort_table_html(const SortTable& table);

}  // namespace bess
