// The numbers of a picture as a CSV file beside the page. Each picture of a page has one and links
// it.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace bess {

inline constexpr std::size_t kMonthTextLength = 7;  ///< of "2023-01"

/// A number to six decimals, nothing without a minus.
std::string exact(double value);

struct PictureTable {
  std::string name;  ///< of the file, without its ending
  std::vector<std::string> columns;
  std::vector<std::vector<std::string>> rows;  ///< as many fields as there are columns
  bool packed = false;                         ///< too long to lie about unpacked
};

/// "lost_days.csv", or ".csv.gz" of a packed one.
std::string picture_file(const PictureTable& table);
std::string picture_csv(const PictureTable& table);
void write_picture(const PictureTable& table, const std::filesystem::path& folder);

/// The link to a file beside the page.
std::string csv_link(std::string_view file);

}  // namespace bess
