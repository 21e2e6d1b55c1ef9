#include "workstation/data/market/feed/market_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <filesystem>
#include <map>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/minute_file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr std::int64_t kHour_s = 3'600;

/// A line or part of one, with its number.
struct TextLine {
  std::size_t number;
  std::string_view text;
};

/// "1/6/2025 9:15" with "dd/mm/yyyy" as "2025-06-01 09:15"; empty if it does not match.
std::string iso_text(std::string_view text, std::string_view format) {
  int year = 0, month = 0, day = 0;
  while (!format.empty()) {
    const char kind = format.front();
    const std::size_t width = std::min(format.find_first_not_of(kind), format.size());
    format.remove_prefix(width);
    if (kind != 'y' && kind != 'm' && kind != 'd') {
      if (!detail::take(text, kind)) return {};
      continue;
    }
    int& part = kind == 'y' ? year : kind == 'm' ? month : day;
    const char* const last = text.data() + std::min(width, text.size());
    const auto taken =
        static_cast<std::size_t>(std::from_chars(text.data(), last, part).ptr - text.data());
    if (taken == 0 || (kind == 'y' && taken < width)) return {};
    text.remove_prefix(taken);
  }
  const bool has_short_hour = text.size() > 2 && text[2] == ':';
  return fmt::format("{:04}-{:02}-{:02}{}{}{}", year, month, day, text.substr(0, 1),
                     has_short_hour ? "0" : "", text.substr(std::min<std::size_t>(1, text.size())));
}

bool shows(std::int64_t utc_s, std::int64_t wall_s) {
  const LocalMinute local = local_minute_of(utc_s);
  const CivilTime wall = civil_from_utc(wall_s);
  return local.day == wall.day && local.minute_of_day == wall.hour * 60 + wall.minute;
}

struct Instant {
  std::int64_t utc_s;
  bool comes_twice = false;  ///< repeated by the clock an hour later
};

[[noreturn]] void refuse(const TextLine& of, std::string_view name, std::string_view why) {
  fail("{}:{}: \"{}\" {}", name, of.number, one_line(of.text, 40), why);
}

Instant instant_of(const TextLine& of, std::string_view name, const CustomTimeFormat& form) {
  const std::string text = iso_text(of.text, form.date_format);
  Instant instant{};
  if (parse_utc(text, instant.utc_s, kAlsoBlank)) return instant;
  if (!parse_utc(text + "Z", instant.utc_s, kAlsoBlank)) {
    refuse(of, name,
           fmt::format("is not a time in the form {} hh:mm; select the order of day and month with "
                       "'prices import --date-format', dd/mm/yyyy or mm/dd/yyyy",
                       form.date_format));
  }
  if (!form.clock) {
    refuse(of, name,
           "is not a time with its UTC offset, e.g. 2023-01-31T00:15:00+01:00: use 'prices import "
           "--time-zone utc', or --time-zone local for Belgian clocks");
  }
  if (*form.clock == WallClock::kUtc) return instant;
  const std::int64_t wall_s = instant.utc_s;
  instant.utc_s = utc_from_local(civil_from_utc(wall_s)) + wall_s % 60;
  if (!shows(instant.utc_s, wall_s)) {
    refuse(of, name, "does not exist in Belgian time (clock change): are the times UTC?");
  }
  instant.comes_twice = shows(instant.utc_s + kHour_s, wall_s);
  return instant;
}

/// In a repeated hour each time must occur twice, in two passes.
void part_hours(std::vector<Instant>& instants, const std::vector<TextLine>& texts,
                std::string_view name) {
  std::map<std::int64_t, std::vector<std::size_t>> rows_of;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (instants[i].comes_twice) rows_of[instants[i].utc_s].push_back(i);
  }
  if (rows_of.empty()) return;
  const bool newest_first = instants.front().utc_s > instants.back().utc_s;
  constexpr const char* kDoubt =
      "occurs twice in Belgian time (clock change), and the order of the rows is ambiguous: "
      "write the times of this hour with their UTC offset";
  for (const auto& [utc_s, rows] : rows_of) {
    if (rows.size() != 2) refuse(texts[rows.back()], name, kDoubt);
    instants[rows[newest_first ? 0 : 1]].utc_s += kHour_s;
  }
  std::optional<std::int64_t> before;
  for (std::size_t i = 0; i < instants.size(); ++i) {
    if (!instants[i].comes_twice) continue;
    if (before && (*before > instants[i].utc_s) != newest_first) refuse(texts[i], name, kDoubt);
    before = instants[i].utc_s;
  }
}

/// UTC instants, one for each text. In a repeated local hour (autumn) the order of the rows
/// decides. Throws UserError.
std::vector<std::int64_t> read_times(const std::vector<TextLine>& texts, std::string_view name,
                                     const CustomTimeFormat& form) {
  std::vector<Instant> instants;
  for (const TextLine& text : texts) instants.push_back(instant_of(text, name, form));
  part_hours(instants, texts, name);
  std::vector<std::int64_t> utc_s;
  for (const Instant& instant : instants) utc_s.push_back(instant.utc_s);
  return utc_s;
}

/// Seconds between prices, 60 or 900, by the majority of neighbours. Throws UserError for others.
std::int64_t step_of_times(std::vector<std::int64_t> utc_s, std::string_view name) {
  std::ranges::sort(utc_s);
  std::map<std::int64_t, std::size_t> count_of;
  for (std::size_t i = 1; i < utc_s.size(); ++i) {
    if (utc_s[i] != utc_s[i - 1]) ++count_of[utc_s[i] - utc_s[i - 1]];
  }
  if (count_of.empty()) return kSecondsPerQuarterHour;
  const std::int64_t step_s =
      std::ranges::max_element(count_of, {}, [](const auto& of) { return of.second; })->first;
  if (step_s == 60 || step_s == kSecondsPerQuarterHour) return step_s;
  fail(
      "{}: a price every {:g} minutes; imbalance prices come every minute or every quarter-hour: "
      "download those (hours are day-ahead prices: prices import --day-ahead)",
      name, static_cast<double>(step_s) / 60);
}

/// Refuses repeated members of one name, which are ambiguous.
void require_each_once(JsonValue object, std::string_view place) {
  std::vector<std::string_view> keys;
  for (const JsonValue item : object) keys.emplace_back(item.key());
  std::ranges::sort(keys);
  const auto twice = std::ranges::adjacent_find(keys);
  if (twice == keys.end()) return;
  fail("{}: \"{}\" occurs twice in one object; download the file again", place,
       one_line(*twice, 40));
}

JsonValue find_records(JsonValue root, std::string_view name) {
  if (root.is_list()) return root;
  if (root.is_object()) require_each_once(root, name);
  for (const char* key : {"results", "records"}) {
    const JsonValue records = root[key];
    if (records.is_list()) return records;
  }
  fail("{}: no list of records (an array, or \"results\"); expected an answer of Elia's API", name);
}

void parse_record(JsonValue record, std::string_view place, MarketRows& rows) {
  if (!record.is_object()) fail("{}: is not an object; download the file again", place);
  require_each_once(record, place);
  const JsonValue fields = record["fields"];
  if (fields.is_object()) require_each_once(fields, place);
  MarketRowBuilder builder(place);
  for (const JsonValue item : fields.is_object() ? fields : record) {
    const std::optional<MarketField> field = market_field_of(item.key());
    if (!field) continue;
    const bool is_text = *field == MarketField::kTime || *field == MarketField::kResolution ||
                         *field == MarketField::kQuarterHour;
    if (const char* text = item.text()) {
      builder.set_text(*field, text);
    } else if (const auto number = item.number(); number && !is_text) {
      builder.set_number(*field, *number);
    } else if (!item.is_null()) {
      fail("{}: \"{}\" has a value of the wrong kind; download the file again", place,
           one_line(item.key(), 40));
    }
  }
  builder.finish(rows);
}

struct Columns {
  char separator;
  std::vector<std::optional<MarketField>> fields;
  bool are_own = false;  ///< no resolution code
  CustomTimeFormat times{};
};

bool is_price(std::optional<MarketField> field) {
  return field == MarketField::kPrice || field == MarketField::kPositivePrice ||
         field == MarketField::kNegativePrice;
}

/// The named column, or the only candidate; nothing without a candidate.
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

/// Selects the columns of time and price; ignores others of these kinds.
void name_own_columns(const std::vector<std::string_view>& labels, const CustomCsvFormat& own,
                      std::string_view name, Columns& columns) {
  auto& fields = columns.fields;
  if (const auto time = own_column(labels, MarketField::kTime, own.time_column, name)) {
    std::ranges::replace(fields, MarketField::kTime, std::nullopt);
    fields[*time] = MarketField::kTime;
    // "datetime_utc" states it.
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

Columns parse_header(std::string_view line, std::string_view name, const CustomCsvFormat& own) {
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
        "{}: no column for the {} in \"{}\"; the header must name a time and a price in "
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

/// Calls `take` for each needed field. `place` names the line in messages.
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

/// `own_step_s` and `own_utc_s` are 0 if the row states its resolution.
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

/// All rows are of one kind. Two different prices of one time are an error.
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
  std::map<std::int64_t, std::pair<double, std::size_t>> prices;  ///< with their lines
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

/// Sources named in the comments at the head, in the words of attribution_of() and the commands.
std::set<MarketSource> sources_of(std::string_view text) {
  std::set<MarketSource> sources;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    if (line.empty()) continue;
    if (!line.starts_with('#')) break;
    const auto says = [line](std::string_view words) { return line.find(words) != line.npos; };
    if (says("opendata.elia.be")) sources.insert(MarketSource::kElia);
    if (says("transparency.entsoe.eu")) sources.insert(MarketSource::kEntsoe);
    if (says("Simulated, not real") || says("a simulated market")) {
      sources.insert(MarketSource::kSimulated);
    }
    if (says("drawn, not real")) sources.insert(MarketSource::kDrawn);
  }
  if (sources.empty()) sources.insert(MarketSource::kUnknown);
  return sources;
}

void add_settled(const MinuteSeries& series, std::size_t minute, std::string_view name,
                 std::vector<QuarterHour>& quarter_hours) {
  const double price = series.settled[minute];
  if (!is_published(price)) return;
  const std::int64_t utc_s = series.utc_s(minute);
  const std::int64_t start_utc_s = utc_s - utc_s % kSecondsPerQuarterHour;
  if (quarter_hours.empty() || quarter_hours.back().utc_s != start_utc_s) {
    QuarterHour row;
    row.utc_s = start_utc_s;
    row.price_eur_per_mwh = price;
    quarter_hours.push_back(row);
  } else if (quarter_hours.back().price_eur_per_mwh != price) {
    fail("{}: the quarter-hour of {} has two settled prices, {} and {}; correct the file", name,
         utc_text(start_utc_s).view(), quarter_hours.back().price_eur_per_mwh, price);
  }
}

/// Whether a spreadsheet saved a minute file with semicolons.
bool is_spreadsheet_minute_csv(std::string_view text) {
  std::string header(csv_header(text));
  if (header.find(';') == header.npos) return false;
  std::ranges::replace(header, ';', ',');
  return is_minute_csv(header);
}

/// That file with commas and decimal points, row by row.
std::string from_spreadsheet(std::string_view text) {
  std::string converted;
  for (std::string_view rest = without_byte_order_mark(text); !rest.empty();) {
    std::string line(take_line(rest));
    if (!line.starts_with('#')) {
      std::ranges::replace(line, ',', '.');
      std::ranges::replace(line, ';', ',');
    }
    converted.append(line).append("\n");
  }
  return converted;
}

/// Indicative prices as minutes, settled ones as quarter-hours; the sources are those named in its
/// comments.
MarketRows parse_minute_file_rows(std::string_view text, std::string_view name) {
  const MinuteSeries series = parse_minute_csv(text, name);
  MarketRows rows;
  rows.is_minute_file = true;
  rows.sources = sources_of(without_byte_order_mark(text));
  for (std::size_t m = 0; m < series.size(); ++m) {
    if (is_published(series.indicative[m])) {
      rows.minutes.push_back({series.utc_s(m), series.indicative[m]});
    }
    add_settled(series, m, name, rows.quarter_hours);
  }
  return rows;
}

/// By MarketSource.
constexpr const char* kSourceWords[] = {
    "Elia, opendata.elia.be, CC BY 4.0 (https://creativecommons.org/licenses/by/4.0/)",
    "ENTSO-E Transparency Platform, transparency.entsoe.eu, by its terms of use",
    "a simulated market of bess-train, not real",
    "minutes by bess-train prices reconstruct: drawn, not real",
    "a file that does not name its source"};

}  // namespace

MarketRows parse_market_json(std::string_view text, std::string_view name) {
  const Json json = Json::parse(text);
  if (!json.value().exists()) {
    fail("{}: not valid JSON, perhaps cut short; download it again", name);
  }
  MarketRows rows;
  std::size_t number = 0;
  std::string place;
  for (const JsonValue record : find_records(json.value(), name)) {
    place.assign(name).append(": record ").append(std::to_string(++number));
    parse_record(record, place, rows);
  }
  return rows;
}

MarketRows parse_market_csv(std::string_view text, std::string_view name,
                            const CustomCsvFormat& own) {
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

MarketRows parse_market_text(std::string_view text, std::string_view name,
                             const CustomCsvFormat& own) {
  text = plain_text(text, name);
  if (text.find_first_not_of(" \t\r\n") == text.npos)
    fail("{}: the file is empty; download it again", name);
  if (looks_like_xml(text)) return parse_entsoe_xml(text, name);
  if (is_minute_csv(text)) return parse_minute_file_rows(text, name);
  if (is_spreadsheet_minute_csv(text)) {
    return parse_minute_file_rows(from_spreadsheet(text), name);
  }
  return looks_like_json(text) ? parse_market_json(text, name) : parse_market_csv(text, name, own);
}

std::string file_names(const std::vector<std::string>& paths) {
  std::vector<std::string> names;
  for (const std::string& path : paths) {
    names.push_back(std::filesystem::path(path).filename().string());
  }
  return fmt::format("{}", fmt::join(names, ", "));
}

std::string attribution_of(const std::set<MarketSource>& sources) {
  std::vector<std::string> names;
  for (const MarketSource source : sources) {
    names.emplace_back(kSourceWords[static_cast<std::size_t>(source)]);
  }
  return fmt::format("Source: {}", fmt::join(names, "; "));
}

}  // namespace bess
