// CSV file of a picture, in the folder of the page and linked from it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bess {

inline constexpr std::size_t kMonthTextLength = 7;  ///< of "2023-01"

/// Number with six decimals, never -0.
std::string exact(double value);

struct PictureTable {
  std::string name;  ///< of the file, without extension
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< one field per column
  bool packed = false;                         ///< compressed file
};

/// Writes "lost_days.csv", or ".csv.gz" if packed, and returns this name.
std::string write_picture(const PictureTable& table, const std::filesystem::path& folder);

/// Link to a file in the folder of the page.
std::string csv_link(std::string_view file);

}  // namespace bess
