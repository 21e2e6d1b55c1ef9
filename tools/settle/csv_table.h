// A small CSV table with named columns: the battery's record and the edge's log, read back.
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bess {

class CsvTable {
 public:
  /// Parses text with one header line. Throws SimError naming file and line when a row has another
  /// number of fields than the header.
  CsvTable(std::string_view text, std::string name);
  static CsvTable read(const std::string& path);

  [[nodiscard]] std::size_t row_count() const { return rows_.size(); }
  /// Index of a column; throws SimError when the file has none of that name.
  [[nodiscard]] std::size_t column(std::string_view name) const;
  [[nodiscard]] const std::string& text(std::size_t row, std::size_t column) const {
    return rows_[row][column];
  }
  /// Field as a number, or as a UTC instant in seconds; throws SimError naming file and line.
  [[nodiscard]] double number(std::size_t row, std::size_t column) const;
  [[nodiscard]] std::int64_t utc_s(std::size_t row, std::size_t column) const;

 private:
  std::string name_;
  std::vector<std::string> header_;
  std::vector<std::vector<std::string>> rows_;
};

}  // namespace bess
