#include "workstation/market/feed/market_csv.h"

#include <fmt/core.h>

#include <algorithm>
#include <map>
#include <string>

#include "shared/host/csv.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

struct Columns {
  char separator;
  std::vector<std::optional<MarketField>> fields;
  bool are_own = false;  ///< without a resolution code
  OwnTimes times{};
};

bool is_price(std::optional<MarketField> field) {
  return field == MarketField::kPrice || field == MarketField::kPositivePrice ||
         field == MarketField::kNegativePrice;
}

/// The one column that is named, or else may be meant; nothing when none may.
std::optional<std::size_t> own_column(const std::vector<std::string_view>& labels,
                                      MarketField field, const std::string& wanted,
                                      std::string_view name) {
  const bool of_time = field == MarketField::kTime;
  std::optional<std::size_t> found;
  for (std::size_t i = 0; i < labels.size(); ++i) {
    const bool fits = wanted.empty() ? may_be_called(labels[i], field)
                                     : plain_name(labels[i]) == plain_name(wanted);
    if (!fits) continue;
    if (found) {
      fail("{}: \"{}\" or \"{}\" may be the {}: name one with 'prices import --{}-column'{}", name,
           one_line(labels[*found], 40), one_line(labels[i], 40), of_time ? "time" : "price",
           of_time ? "time" : "price", of_time ? ", date and time of day in one column" : "");
    }
    found = i;
  }
  if (found && !of_time && plain_name(labels[*found]).ends_with("kwh")) {
    fail("{}: \"{}\" is not in EUR/MWh: multiply EUR/kWh by 1000, ct/kWh by 10", name,
         one_line(labels[*found], 40));
  }
  return found;
}

/// Names the columns of time and price; other fields of that kind are none.
void name_own_columns(const std::vector<std::string_view>& labels, const OwnForm& own,
                      std::string_view name, Columns& columns) {
  auto& fields = columns.fields;
  if (const auto time = own_column(labels, MarketField::kTime, own.time_column, name)) {
    std::ranges::replace(fields, MarketField::kTime, std::nullopt);
    fields[*time] = MarketField::kTime;
    // "datetime_utc" says it.
    const bool is_utc = plain_name(labels[*time]).ends_with("utc");
    if (is_utc && !columns.times.clock) columns.times.clock = WallClock::kUtc;
  } else if (own.time_column.empty()) {
    std::ranges::replace(fields, MarketField::kQuarterHour, MarketField::kTime);
  }
  if (const auto price = own_column(labels, MarketField::kPrice, own.price_column, name)) {
    std::ranges::replace_if(fields, is_price, std::nullopt);
    fields[*price] = MarketField::kPrice;
  }
}

Columns parse_header(std::string_view line, std::string_view name, const OwnForm& own) {
  const std::size_t separator = std::min(line.find(';'), line.find('\t'));
  Columns columns{.separator = separator == line.npos ? ',' : line[separator], .fields = {}};
  std::vector<std::string_view> labels;
  CsvFields taken(line, columns.separator);
  for (std::string_view label; taken.take(label);) {
    columns.fields.push_back(market_field_of(label));
    labels.push_back(label);
  }
  const auto has = [&columns](MarketField field) {
    return std::ranges::find(columns.fields, field) != columns.fields.end();
  };
  columns.are_own = !has(MarketField::kResolution);
  columns.times = own.times;
  if (columns.are_own) name_own_columns(labels, own, name, columns);
  const bool has_time = has(MarketField::kTime);
  if (!has_time || std::ranges::none_of(columns.fields, is_price)) {
    throw NotMarketData(fmt::format(
        "{}: no column for the {} in \"{}\"; needed is a header that names a time and a price in "
        "EUR/MWh, e.g. datetime_utc,price_eur_mwh above 2025-01-31T00:15:00Z,85.30; other names: "
        "'prices import --time-column, --price-column'",
        name, has_time ? "imbalance price" : "time", one_line(line, 80)));
  }
  return columns;
}

std::string_view without_blanks(std::string_view text) {
  const std::size_t first = text.find_first_not_of(' ');
  return first == text.npos ? "" : text.substr(first, text.find_last_not_of(' ') + 1 - first);
}

/// Each field that is needed. `place` names the line in messages.
template <typename Take>
void take_fields(std::string_view line, const Columns& columns, std::string_view place, Take take) {
  CsvFields fields(line, columns.separator);
  std::size_t column = 0;
  for (std::string_view text; fields.take(text); ++column) {
    if (column < columns.fields.size() && columns.fields[column]) {
      take(*columns.fields[column], without_blanks(text));
    }
  }
  if (column != columns.fields.size()) {
    fail("{}: {} columns where the header has {}; the file may be cut short, download it again",
         place, column, columns.fields.size());
  }
}

std::string place_of(std::string_view name, std::size_t line) {
  return std::string(name).append(":").append(std::to_string(line));
}

/// `own_step_s` is 0 where the row itself says its resolution, and `own_utc_s` its time then.
void add_row(const TextLine& line, const Columns& columns, std::string_view name, MarketRows& rows,
             std::int64_t own_utc_s = 0, std::int64_t own_step_s = 0) {
  const std::string place = place_of(name, line.number);
  MarketRowBuilder builder(place, columns.separator != ',');
  take_fields(line.text, columns, place, [&](MarketField field, std::string_view text) {
    if (columns.are_own && field == MarketField::kTime) return builder.set_time(own_utc_s);
    builder.set_text(field, text);
  });
  if (own_step_s == 60) builder.set_minute();
  builder.finish(rows);
}

/// All rows are of one kind. Two prices of one time that differ are an error.
void add_own_rows(const std::vector<TextLine>& lines, const Columns& columns, std::string_view name,
                  MarketRows& rows) {
  std::vector<TextLine> texts;
  for (const TextLine& line : lines) {
    take_fields(line.text, columns, place_of(name, line.number),
                [&](MarketField field, std::string_view text) {
                  if (field == MarketField::kTime) texts.push_back({line.number, text});
                });
  }
  const std::vector<std::int64_t> utc_s = read_times(texts, name, columns.times);
  const std::int64_t step_s = step_of_times(utc_s, name);
  std::map<std::int64_t, std::pair<double, std::size_t>> prices;  ///< and their lines
  for (std::size_t i = 0; i < lines.size(); ++i) {
    add_row(lines[i], columns, name, rows, utc_s[i], step_s);
    const double price = rows.minutes.empty() ? rows.quarter_hours.back().price_eur_per_mwh
                                              : rows.minutes.back().indicative_eur_per_mwh;
    if (!is_published(price)) continue;
    const auto [at, is_new] = prices.try_emplace(utc_s[i], price, lines[i].number);
    if (const auto [other, line] = at->second; other != price) {
      fail("{}: another price than in line {} for the same time: {} and {}; delete the wrong one",
           place_of(name, lines[i].number), line, price, other);
    }
  }
}

}  // namespace

MarketRows parse_market_csv(std::string_view text, std::string_view name, const OwnForm& own) {
  MarketRows rows;
  std::optional<Columns> columns;
  std::vector<TextLine> own_lines;
  for (std::size_t number = 1; !text.empty(); ++number) {
    const TextLine line{number, take_line(text)};
    if (line.text.empty() || line.text[0] == '#') continue;
    if (!columns) {
      columns = parse_header(line.text, name, own);
    } else if (columns->are_own) {
      own_lines.push_back(line);
    } else {
      add_row(line, *columns, name, rows);
    }
  }
  if (!columns) fail("{}: the file is empty; download it again", name);
  if (!own_lines.empty()) add_own_rows(own_lines, *columns, name, rows);
  return rows;
}

}  // namespace bess
