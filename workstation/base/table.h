// Tables: rows under named columns, written as aligned text, CSV and JSON; report/figures/html.h
// writes HTML.
#pragma once

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "shared/host/json.h"

namespace bess {

/// Value of a cell: a number (NaN: unknown) or a text.
struct TableValue {
  template <typename T>
  TableValue(const T& value) {  // NOLINT: implicit on purpose
    if constexpr (std::is_arithmetic_v<T>) {
      number = static_cast<double>(value);
    } else {
      text = value;
      is_text = true;
    }
  }
  double number = std::numeric_limits<double>::quiet_NaN();
  std::string text{};
  bool is_text = false;
};

/// In CSV and JSON: shortest exact form of a number.
inline constexpr int kAllDecimals = -1;

struct ColumnName {
  std::string key{};            ///< in CSV and JSON; empty: omitted
  std::string head{};           ///< in the terminal; empty: omitted
  std::string form{};           ///< fmt format of a shown number; with "%", a share in percent
  int decimals = kAllDecimals;  ///< of a number in CSV and JSON
  std::string title{};          ///< on a page; empty: omitted
};

/// A column and its value for each row.
template <typename Row>
struct Column {
  ColumnName name;
  std::function<TableValue(const Row& row)> value;
};

class Table {
 public:
  Table() = default;
  template <typename Row>
  Table(const std::vector<Column<Row>>& columns, const std::vector<Row>& rows) {
    for (const Column<Row>& column : columns) add(column, rows);
  }

  /// Appends a column; all columns have the same number of rows.
  template <typename Row>
  void add(const Column<Row>& column, const std::vector<Row>& rows) {
    columns_.push_back({column.name, {}});
    for (const Row& row : rows) columns_.back().values.push_back(column.value(row));
  }
  /// The columns with these keys ("policy,days"), in this order.
  [[nodiscard]] Table only(std::string_view keys) const;

  [[nodiscard]] std::size_t size() const;
  /// Aligned columns: one line of heads, one line per row; unknown values are "-".
  [[nodiscard]] std::string text() const;
  /// One line of keys, one line per row; unknown values are empty.
  [[nodiscard]] std::string csv() const;
  /// Sets the keys of one row; unknown values and empty texts are null.
  void add_row(std::size_t row, Json& json) const;
  /// List of objects, one per row.
  [[nodiscard]] Json json() const;

  struct Entry {
    ColumnName name;
    std::vector<TableValue> values;
  };
  [[nodiscard]] const std::vector<Entry>& columns() const { return columns_; }

 private:
  std::vector<Entry> columns_;
};

/// Value as shown; `unknown` if not known.
std::string shown_value(const TableValue& value, const ColumnName& name,
                        std::string_view unknown = "-");

}  // namespace bess
