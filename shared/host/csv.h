// Comma-separated values: fields, and a small table with named columns.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

/// Field for output, quoted if necessary.
std::string csv_field(std::string_view text);

/// Header line: the first that is neither empty nor a comment. A view into `text`.
std::string_view csv_header(std::string_view text);

/// Fields of one line, without copies. Separators in quotes are part of the field.
class CsvFields {
 public:
  explicit CsvFields(std::string_view line, char separator = ',')
      : rest_(line), separator_(separator) {}
  /// Next field without its quotes; doubled quotes inside remain. False at the end.
  bool take(std::string_view& field);

 private:
  std::string_view rest_;
  char separator_;
  bool more_ = true;
};

/// Text with one header line. Skips empty lines and # comments.
class CsvTable {
 public:
  /// Throws UserError naming file and line if the header differs from a given `header`, a row has
  /// another number of fields, or there are no rows.
  CsvTable(std::string_view text, std::string name, std::string_view header = {});
  static CsvTable read(const std::string& path);

  [[nodiscard]] std::size_t row_count() const { return rows_.size(); }
  /// Index of a column; throws UserError if missing.
  [[nodiscard]] std::size_t column(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const {
    return rows_[row].fields[column];
  }
  /// Line number of a row, from 1, for messages.
  [[nodiscard]] std::size_t line(std::size_t row) const { return rows_[row].line; }
  /// Field as a number, or as a UTC instant in seconds; throws UserError naming file and line.
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  /// Whole number from `low` to `high`.
  [[nodiscard]] std::int64_t whole(std::size_t row, std::size_t column, std::int64_t low,
                                   std::int64_t high) const;
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
