// HTML pages: static files, tables, CSV files of pictures, pages of text, and the report page.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/json.h"
#include "shared/host/text.h"
#include "workstation/base/table.h"

namespace bess {

// Static files of the page, embedded into the program (page/page.cmake), so that a page is one
// self-contained file.

/// Contents of report/page/`name`, of "chart.min.js" or "answers.schema.json". Throws
/// std::logic_error for another name.
std::string_view page_file(std::string_view name);

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

// CSV file of a picture, in the folder of the page and linked from it.

inline constexpr std::size_t kMonthTextLength = 7;  ///< of "2023-01"

/// Number with six decimals, never -0.
std::string exact(double value);

struct PictureFile {
  std::string name;  ///< "lost_days.csv", or ".csv.gz" if compressed
  std::string csv;
};

/// Link to a file in the folder of the page.
std::string csv_link(std::string_view file);

/// Complete, self-contained document for light, dark, phone and print.
std::string format_page(std::string_view title, std::string_view body);

// Report page (page/report.html) and pages with charts, with style, scripts and data embedded.

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

// Heat map of a result over two settings, and starts of price regimes in a picture.

// Heat map over two numeric settings, as an accessible table with coloured cells.

struct HeatValue {
  double value, error;  ///< standard error; NaN: unknown
};

/// Value of a cell's colour: 0 within two standard errors of zero, or without an error; `left`, the
/// shade of the cell to its left, within two standard errors of it; else its own.
HeatValue shade_of(const HeatValue& cell, const HeatValue& left);

struct HeatPoint {
  std::string across, down;  ///< values of the two settings
  HeatValue of;              ///< an unknown value is shown empty
};

inline constexpr const char* kShadeMeaning =
    "pale: within two standard errors of zero; equal shade: within two of the cell to the left";

/// Names of the two settings; `what` is the caption, `id` the unique id of the table.
struct HeatMapText {
  std::string across, down, what, id;
};

std::string heat_map_html(const std::vector<HeatPoint>& points, const HeatMapText& text);

// Starts of price regimes within the days of a picture.

/// [index, change] of each boundary within `dates`, which are ascending.
Json regime_marks(const std::vector<std::string>& dates);

}  // namespace bess
