#include "workstation/report/figures/picture_table.h"

#include <fmt/core.h>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "workstation/report/figures/html.h"

namespace bess {
namespace {

std::string line_of(const std::vector<std::string>& fields) {
  std::string line;
  for (const std::string& field : fields) line += csv_field(field) + ',';
  line.back() = '\n';
  return line;
}

}  // namespace

std::string exact(double value) {
  const std::string text = fmt::format("{:.6f}", value);
  return text == "-0.000000" ? text.substr(1) : text;
}

std::string write_picture(const PictureTable& table, const std::filesystem::path& folder) {
  std::string text = line_of(table.columns);
  for (const auto& row : table.rows) text += line_of(row);
  std::string file = table.name + (table.packed ? ".csv.gz" : ".csv");
  write_file(folder / file, text);
  return file;
}

std::string csv_link(std::string_view file) {
  return fmt::format("<a class=\"csv\" href=\"{0}\" download>{0}</a>", html_escaped(file));
}

}  // namespace bess
