#include "shared/host/csv.h"

#include <algorithm>
#include <cmath>

#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// Closing quote of `field`; npos: none.
std::size_t closing_quote(std::string_view field) {
  std::size_t at = field.find('"', 1);
  while (at != field.npos && field.substr(at + 1).starts_with('"')) at = field.find('"', at + 2);
  return at;
}

std::string undoubled(std::string_view field) {
  std::string text;
  for (std::size_t i = 0; i < field.size(); ++i) {
    text += field[i];
    if (field.substr(i).starts_with("\"\"")) ++i;
  }
  return text;
}

std::vector<std::string> fields_of(std::string_view line) {
  std::vector<std::string> all;
  CsvFields fields(line);
  for (std::string_view field; fields.take(field);) all.push_back(undoubled(field));
  return all;
}

}  // namespace

std::string csv_field(std::string_view text) {
  if (text.find_first_of(",\"\n") == std::string_view::npos) return std::string(text);
  std::string quoted = "\"";
  for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
  return quoted + "\"";
}

std::string_view csv_header(std::string_view text) {
  text = without_byte_order_mark(text);
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (!line.empty() && !line.starts_with('#')) return line;
  }
  return {};
}

bool CsvFields::take(std::string_view& field) {
  if (!more_) return false;
  const std::size_t closing = rest_.starts_with('"') ? closing_quote(rest_) : 0;
  const std::size_t end = rest_.find(separator_, closing == rest_.npos ? 0 : closing);
  field = rest_.substr(0, end);
  more_ = end != rest_.npos;
  rest_.remove_prefix(more_ ? end + 1 : rest_.size());
  if (field.size() >= 2 && field.front() == '"' && field.back() == '"') {
    field = field.substr(1, field.size() - 2);
  }
  return true;
}

CsvTable::CsvTable(std::string_view text, std::string name, std::string_view header)
    : name_(std::move(name)) {
  text = plain_text(text, name_);
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::string_view line = take_line(text);
    if (line.empty() || line.starts_with('#')) continue;
    std::vector<std::string> fields = fields_of(line);
    if (header_.empty()) {
      if (!header.empty() && line != header) {
        fail("{}:{}: the header must be \"{}\"", name_, line_number, header);
      }
      header_ = std::move(fields);
    } else if (fields.size() != header_.size()) {
      fail("{}:{}: {} fields, the header has {}", name_, line_number, fields.size(),
           header_.size());
    } else {
      rows_.push_back({line_number, std::move(fields)});
    }
  }
  if (rows_.empty()) fail("{}: has no rows", name_);
}

CsvTable CsvTable::read(const std::string& path) { return {read_file(path), path}; }

std::size_t CsvTable::column(std::string_view name) const {
  const auto found = std::ranges::find(header_, name);
  if (found == header_.end()) fail("{}: has no column \"{}\"", name_, name);
  return static_cast<std::size_t>(found - header_.begin());
}

double CsvTable::number(std::size_t row, std::size_t column) const {
  const std::string& field = text(row, column);
  double value = 0;
  if (!read_number(field, value) || !std::isfinite(value)) {
    fail("{}:{}: {} \"{}\" is not a number", name_, rows_[row].line, header_[column],
         one_line(field, 40));
  }
  return value;
}

std::int64_t CsvTable::whole(std::size_t row, std::size_t column, std::int64_t low,
                             std::int64_t high) const {
  const double value = number(row, column);
  if (value >= static_cast<double>(low) && value <= static_cast<double>(high) &&
      value == std::floor(value)) {
    return static_cast<std::int64_t>(value);
  }
  fail("{}:{}: {} \"{}\" is not a whole number from {} to {}", name_, line(row), header_[column],
       text(row, column), low, high);
}

std::int64_t CsvTable::utc_s(std::size_t row, std::size_t column) const {
  std::int64_t value = 0;
  if (!parse_utc(text(row, column), value)) {
    fail("{}:{}: {} \"{}\" is not a UTC time", name_, rows_[row].line, header_[column],
         one_line(text(row, column), 40));
  }
  return value;
}

}  // namespace bess
