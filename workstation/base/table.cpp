#include "workstation/base/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "shared/host/csv.h"
#include "workstation/base/answer.h"

namespace bess {
namespace {

std::string csv_value(const TableValue& value, int decimals) {
  if (value.is_text) return csv_field(value.text);
  if (!std::isfinite(value.number)) return {};
  return decimals == kAllDecimals ? fmt::format("{}", value.number)
                                  : fmt::format("{:.{}f}", value.number, decimals);
}

Json json_value(const TableValue& value, int decimals) {
  if (value.is_text) return text_or_null(value.text);
  return decimals == kAllDecimals ? Json(value.number) : Json(Decimals{value.number, decimals});
}

}  // namespace

Table Table::only(std::string_view keys) const {
  Table picked;
  CsvFields fields(keys);
  for (std::string_view key; fields.take(key);) {
    const auto found =
        std::ranges::find_if(columns_, [&](const Entry& entry) { return entry.name.key == key; });
    if (found == columns_.end()) throw std::logic_error("no column " + std::string(key));
    picked.columns_.push_back(*found);
  }
  return picked;
}

std::size_t Table::size() const { return columns_.empty() ? 0 : columns_.front().values.size(); }

std::string Table::text() const {
  std::vector<std::string> lines(size() + 1);
  for (const auto& [name, values] : columns_) {
    if (name.head.empty()) continue;
    std::vector<std::string> cells{name.head};
    for (const TableValue& value : values) cells.push_back(shown_value(value, name));
    const std::size_t width = std::ranges::max(cells, {}, &std::string::size).size();
    const bool is_text = std::ranges::any_of(values, &TableValue::is_text);
    for (std::size_t line = 0; line < lines.size(); ++line) {
      lines[line] += lines[line].empty() ? "" : "  ";
      lines[line] += is_text ? fmt::format("{:<{}}", cells[line], width)
                             : fmt::format("{:>{}}", cells[line], width);
    }
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

std::string Table::csv() const {
  std::vector<std::string> lines(size() + 1);
  for (const auto& [name, values] : columns_) {
    if (name.key.empty()) continue;
    const char* const comma = lines.front().empty() ? "" : ",";
    lines.front().append(comma).append(name.key);
    for (std::size_t row = 0; row < values.size(); ++row) {
      lines[row + 1].append(comma).append(csv_value(values[row], name.decimals));
    }
  }
  return fmt::format("{}\n", fmt::join(lines, "\n"));
}

void Table::add_row(std::size_t row, Json& json) const {
  for (const auto& [name, values] : columns_) {
    if (!name.key.empty()) json.set(name.key.c_str(), json_value(values[row], name.decimals));
  }
}

Json Table::json() const {
  Json list = Json::list();
  for (std::size_t row = 0; row < size(); ++row) {
    Json object = Json::object();
    add_row(row, object);
    list.add(std::move(object));
  }
  return list;
}

std::string shown_value(const TableValue& value, const ColumnName& name, std::string_view unknown) {
  if (value.is_text) return value.text;
  if (std::isnan(value.number)) return std::string(unknown);
  if (name.form.empty()) return fmt::format("{:g}", value.number);
  const bool is_share = name.form.find('%') != std::string::npos;
  return fmt::format(fmt::runtime(name.form), is_share ? 100 * value.number : value.number);
}

}  // namespace bess
