// Tables: rows under named columns, written as aligned text, CSV and JSON here, and as HTML by
// report/figures/html.h and sort_table.h.
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

/// What a row has in a column: a number, NaN where it is not known, or a text.
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

/// In CSV and JSON: as many decimals as a number has.
inline constexpr int kAllDecimals = -1;

struct ColumnName {
  std::string key{};   ///< in CSV and JSON; empty: only shown
  std::string head{};  ///< in the terminal; empty: not there
  std::string form{};  ///< of a shown number, as fmt's; one with "%" shows a share in percent
  int decimals = kAllDecimals;  ///< of a number in CSV and JSON
  std::string title{};          ///< on a page; empty: not there
};

/// A column and what each row has in it.
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

  /// A column to the right; each has as many rows as the first.
  template <typename Row>
  void add(const Column<Row>& column, const std::vector<Row>& rows) {
    columns_.push_back({column.name, {}});
    for (const Row& row : rows) columns_.back().values.push_back(column.value(row));
  }
  void add(const Table& right);
  /// The columns of these keys, "policy,days", in that order.
  [[nodiscard]] Table only(std::string_view keys) const;

  [[nodiscard]] std::size_t size() const;
  /// For people, in aligned columns: a line of heads and one a row; what is not known is "-".
  [[nodiscard]] std::string text() const;
  /// A line of keys and one a row; what is not known is empty.
  [[nodiscard]] std::string csv() const;
  /// Sets the keys of one row; what is not known is null, and so is an empty text.
  void add_row(std::size_t row, Json& json) const;
  /// The rows as a list of objects.
  [[nodiscard]] Json json() const;

  struct Entry {
    ColumnName name;
    std::vector<TableValue> values;
  };
  [[nodiscard]] const std::vector<Entry>& columns() const { return columns_; }

 private:
  std::vector<Entry> columns_;
};

/// A value as it is shown; `unknown` where it is not known.
std::string shown_value(const TableValue& value, const ColumnName& name,
                        std::string_view unknown = "-");

}  // namespace bess
