#include "tools/settle/csv_table.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fstream>
#include <sstream>

#include "shared/utc_text.h"
#include "tools/sim/sim_error.h"

namespace bess {
namespace {

std::vector<std::string> split(std::string_view line) {
  std::vector<std::string> fields(1);
  for (const char c : line) {
    if (c == ',') {
      fields.emplace_back();
    } else if (c != '\r') {
      fields.back() += c;
    }
  }
  return fields;
}

}  // namespace

CsvTable::CsvTable(std::string_view text, std::string name) : name_(std::move(name)) {
  for (std::size_t line = 1; !text.empty(); ++line) {
    const std::size_t end = text.find('\n');
    const std::vector<std::string> fields = split(text.substr(0, end));
    text.remove_prefix(end == std::string_view::npos ? text.size() : end + 1);
    if (header_.empty()) {
      header_ = fields;
    } else if (fields.size() != header_.size()) {
      sim_fail("{}:{}: {} fields, the header has {}", name_, line, fields.size(), header_.size());
    } else {
      rows_.push_back(fields);
    }
  }
  if (rows_.empty()) sim_fail("{}: holds no rows", name_);
}

CsvTable CsvTable::read(const std::string& path) {
  std::ifstream file(path);
  if (!file) sim_fail("{}: cannot open", path);
  std::ostringstream text;
  text << file.rdbuf();
  return {text.str(), path};
}

std::size_t CsvTable::column(std::string_view name) const {
  const auto found = std::ranges::find(header_, name);
  if (found == header_.end()) sim_fail("{}: has no column \"{}\"", name_, name);
  return static_cast<std::size_t>(found - header_.begin());
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& field = rows_[row][column];
  double value = 0;
  const auto [end, error] = std::from_chars(field.data(), field.data() + field.size(), value);
  if (error != std::errc{} || end != field.data() + field.size() || !std::isfinite(value)) {
    sim_fail("{}:{}: {} \"{}\" is not a number", name_, row + 2, header_[column], field);
  }
  return value;
}

std::int64_t CsvTable::utc_s(std::size_t row, std::size_t column) const {
  std::int64_t value = 0;
  if (!parse_utc_text(rows_[row][column], value)) {
    sim_fail("{}:{}: {} \"{}\" is not a UTC time", name_, row + 2, header_[column],
             rows_[row][column]);
  }
  return value;
}

}  // namespace bess
