// Comma-separated values: a field out and in, and a small table with named columns.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

/// A field as it is written: quoted where it must be.
std::string csv_field(std::string_view text);

/// The line that names the columns: the first that is neither empty nor a comment. A view into
/// `text`.
std::string_view csv_header(std::string_view text);

/// The fields of one line, without copying them. Quotes keep a separator inside.
class CsvFields {
 public:
  explicit CsvFields(std::string_view line, char separator = ',')
      : rest_(line), separator_(separator) {}
  /// The next field, its quotes taken off; doubled ones inside stay doubled. False at the end.
  bool take(std::string_view& field);

 private:
  std::string_view rest_;
  char separator_;
  bool more_ = true;
};

/// A text with one header line, read whole. Empty lines and # comments are passed over.
class CsvTable {
 public:
  /// Throws UserError naming file and line when the header is another than `header`, if that is
  /// given, when a row has another number of fields than it, or when there is no row.
  CsvTable(std::string_view text, std::string name, std::string_view header = {});
  static CsvTable read(const std::string& path);

  [[nodiscard]] std::size_t row_count() const { return rows_.size(); }
  /// Index of a column; throws UserError when the file has none of that name.
  [[nodiscard]] std::size_t column(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const {
    return rows_[row].fields[column];
  }
  /// Of a row in the text, counted from 1: for a message about it.
  [[nodiscard]] std::size_t line(std::size_t row) const { return rows_[row].line; }
  /// Field as a number, or as a UTC instant in seconds; throws UserError naming file and line.
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  [[nodiscard]] std::int64_t utc_s(std::size_t row, std::size_t column) const;

 private:
  struct Row {
    std::size_t line;  ///< counted from 1
    std::vector<std::string> fields;
  };
  std::string name_;
  std::vector<std::string> header_;
  std::vector<Row> rows_;
};

}  // namespace bess
