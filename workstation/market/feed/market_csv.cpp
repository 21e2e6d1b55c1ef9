#include "workstation/market/feed/market_csv.h"

#include <fmt/core.h>

#include <string>

#include "shared/host/csv.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

struct Columns {
  char separator;
  std::vector<std::optional<MarketField>> fields;
};

Columns parse_header(std::string_view line, std::string_view name) {
  Columns columns{.separator = line.find(';') != std::string_view::npos ? ';' : ',', .fields = {}};
  bool has_time = false;
  bool has_price = false;
  CsvFields labels(line, columns.separator);
  for (std::string_view label; labels.take(label);) {
    const std::optional<MarketField> field = market_field_of(label);
    has_time |= field == MarketField::kTime;
    has_price |= field == MarketField::kPrice || field == MarketField::kPositivePrice ||
                 field == MarketField::kNegativePrice;
    columns.fields.push_back(field);
  }
  if (!has_time || !has_price) {
    throw NotMarketData(fmt::format(
        "{}: no column for the {}; expected a download of ods046, ods047, ods133, ods134, ods161 "
        "or ods162",
        name, has_time ? "imbalance price" : "time (Datetime)"));
  }
  return columns;
}

void parse_row(std::string_view line, const Columns& columns, std::string_view place,
               MarketRows& rows) {
  MarketRowBuilder builder(place, columns.separator == ';');
  CsvFields fields(line, columns.separator);
  std::size_t column = 0;
  for (std::string_view text; fields.take(text);) {
    if (column < columns.fields.size() && columns.fields[column]) {
      builder.set_text(*columns.fields[column], text);
    }
    ++column;
  }
  if (column != columns.fields.size()) {
    fail("{}: {} columns where the header has {}; the file may be cut short, download it again",
         place, column, columns.fields.size());
  }
  builder.finish(rows);
}

}  // namespace

MarketRows parse_market_csv(std::string_view text, std::string_view name) {
  MarketRows rows;
  std::optional<Columns> columns;
  std::size_t line_number = 0;
  std::string place;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    ++line_number;
    if (line.empty() || line[0] == '#') continue;
    if (!columns) {
      columns = parse_header(line, name);
      continue;
    }
    place.assign(name).append(":").append(std::to_string(line_number));
    parse_row(line, *columns, place, rows);
  }
  if (!columns) fail("{}: the file is empty; download it again", name);
  return rows;
}

}  // namespace bess
