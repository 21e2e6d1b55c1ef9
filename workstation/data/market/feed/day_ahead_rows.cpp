#include "workstation/data/market/feed/day_ahead_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

struct TidyColumns {
  char separator = ',';
  std::optional<std::size_t> time, price, resolution, published;
  std::size_t count = 0;
};

TidyColumns tidy_columns(std::string_view header, std::string_view name) {
  constexpr std::array<std::string_view, 7> kTimes{
      "datetime", "datetimeutc", "quarterhourutc", "time", "timeutc", "utc", "timestamputc"};
  constexpr std::array<std::string_view, 6> kPrices{
      "price",         "priceeurmwh",         "dayaheadeurmwh",
      "dayaheadprice", "dayaheadpriceeurmwh", "priceeurpermwh"};
  TidyColumns columns;
  columns.separator = header.find(';') == header.npos ? ',' : ';';
  CsvFields labels(header, columns.separator);
  for (std::string_view label; labels.take(label); ++columns.count) {
    const std::string plain = plain_name(label);
    if (std::ranges::find(kTimes, plain) != kTimes.end()) columns.time = columns.count;
    if (std::ranges::find(kPrices, plain) != kPrices.end()) columns.price = columns.count;
    if (plain == "resolutionmin") columns.resolution = columns.count;
    if (plain == "publishedutc") columns.published = columns.count;
  }
  if (!columns.time || !columns.price) {
    fail(
        "{}: no column for the {}; day-ahead prices come as ENTSO-E A44 (XML), energy-charts JSON, "
        "or CSV with the columns datetime_utc and price_eur_mwh",
        name, columns.time ? "price (price_eur_mwh)" : "time (datetime_utc)");
  }
  return columns;
}

/// With semicolons as separators "1,5" is a number.
bool parse_decimal(std::string_view field, char separator, double& value) {
  std::string text(field);
  if (separator == ';') std::ranges::replace(text, ',', '.');
  return read_number(text, value) && std::isfinite(value);
}

DayAheadRow tidy_row(std::string_view line, const TidyColumns& columns, const std::string& place) {
  std::vector<std::string_view> fields;
  CsvFields taken(line, columns.separator);
  for (std::string_view field; taken.take(field);) fields.push_back(field);
  if (fields.size() != columns.count) {
    fail("{}: {} columns where the header has {}; file cut short? download it again", place,
         fields.size(), columns.count);
  }
  DayAheadRow row{};
  if (!parse_utc(fields[*columns.time], row.utc_s, kAlsoBlank)) {
    fail("{}: \"{}\" is not a time with Z or an offset, e.g. 2025-06-01T10:00:00Z", place,
         one_line(fields[*columns.time], 40));
  }
  const std::string_view price = fields[*columns.price];
  row.eur_per_mwh = kNotPublished;
  if (!is_absent(price) && !parse_decimal(price, columns.separator, row.eur_per_mwh)) {
    fail("{}: \"{}\" is not a price", place, one_line(price, 40));
  }
  double resolution = 0;
  if (columns.resolution && parse_decimal(fields[*columns.resolution], ',', resolution)) {
    row.resolution_min =
        resolution == 15 || resolution == 30 || resolution == 60 ? static_cast<int>(resolution) : 0;
  }
  if (columns.published && !fields[*columns.published].empty() &&
      !parse_utc(fields[*columns.published], row.published_utc_s, kAlsoBlank)) {
    fail("{}: \"{}\" is not a time of publication; leave it empty if unknown", place,
         one_line(fields[*columns.published], 40));
  }
  return row;
}

std::vector<DayAheadRow> parse_tidy_day_ahead(std::string_view text, std::string_view name) {
  std::optional<TidyColumns> columns;
  std::vector<DayAheadRow> rows;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::string_view line = take_line(text);
    if (line.empty() || line[0] == '#') continue;
    if (!columns) {
      columns = tidy_columns(line, name);
    } else {
      rows.push_back(tidy_row(line, *columns, fmt::format("{}:{}", name, line_number)));
    }
  }
  if (!columns) fail("{}: the file is empty; download it again", name);
  return rows;
}

}  // namespace

std::vector<DayAheadRow> parse_energy_charts(std::string_view text, std::string_view name) {
  DayAheadAnswer answer = parse_day_ahead_json(text);
  if (!answer.trouble.empty()) {
    fail("{}: not an energy-charts answer, or cut short: {}; download it again", name,
         answer.trouble);
  }
  if (answer.passed_over > 0) {
    fail("{}: unix_seconds has {} invalid times; download it again", name, answer.passed_over);
  }
  return std::move(answer.rows);
}

DayAheadFile parse_day_ahead_text(std::string_view text, std::string_view name) {
  text = plain_text(text, name);
  if (looks_like_xml(text)) return parse_entsoe_day_ahead(text, name);
  if (looks_like_json(text)) return {.rows = parse_energy_charts(text, name)};
  return {.rows = parse_tidy_day_ahead(text, name)};
}

std::vector<DayAheadRow> rows_of_one_zone(const std::vector<std::string>& paths,
                                          std::vector<std::string>& notes) {
  std::vector<DayAheadRow> rows;
  std::string zone, path_of_zone;
  for (const std::string& path : paths) {
    const DayAheadFile file = parse_day_ahead_text(read_file(path), path);
    if (!zone.empty() && !file.zone.empty() && file.zone != zone) {
      fail("{}: prices of the zone {}, and {} has those of {}; import one zone at a time", path,
           file.zone, path_of_zone, zone);
    }
    if (zone.empty() && !file.zone.empty()) zone = file.zone, path_of_zone = path;
    if (!file.unused.empty()) notes.push_back(fmt::format("{}: {}", path, file.unused));
    rows.insert(rows.end(), file.rows.begin(), file.rows.end());
  }
  return rows;
}

JoinedDayAhead join_day_ahead(std::vector<DayAheadRow> rows, std::string_view name) {
  const DayAheadLayout layout = lay_out_day_ahead(std::move(rows));
  if (!layout.trouble.empty()) fail("{}: {}; correct the times", name, layout.trouble);
  JoinedDayAhead joined;
  if (layout.contradiction_utc_s != 0) {
    joined.findings.push_back(
        {"overlap", true,
         fmt::format("two day-ahead prices for one time, {} and {}: remove one (if accepted, the "
                     "later one counts)",
                     layout.contradicting_eur_per_mwh[0], layout.contradicting_eur_per_mwh[1]),
         layout.contradiction_utc_s});
  }
  for (const DayAheadDay& day : layout.days) {
    joined.constant_days += day.is_constant() ? 1 : 0;
    if (day.is_constant()) continue;
    for (const DayAheadQuarterHour& q : day.quarter_hours) {
      joined.assumed += q.is_assumed ? 1 : 0;
      if (q.is_assumed) continue;
      if (!append_day_ahead(joined.series,
                            {q.utc_s, q.eur_per_mwh, day.resolution_min, q.published_utc_s})) {
        fail("{}: {} is more than 40 years after the first row; correct the date", name,
             utc_text(q.utc_s).view());
      }
    }
    if (day.resolution_min == 60) joined.repeated_hours += day.quarter_hours.size() / 4;
  }
  if (joined.series.size() == 0) fail("{}: has no day-ahead prices; choose other days", name);
  return joined;
}

std::string describe_day_ahead(const JoinedDayAhead& joined) {
  const DayAheadSeries& series = joined.series;
  const auto prices = static_cast<std::size_t>(
      std::ranges::count_if(series.eur_per_mwh, [](double price) { return is_published(price); }));
  std::string text =
      fmt::format("{} of day-ahead prices from {} to {}, of them {} repeated\n",
                  counted(prices, "quarter-hour"), utc_text(series.utc_s(0)).view(),
                  utc_text(series.end_utc_s()).view(), counted(joined.repeated_hours, "hour"));
  if (joined.assumed > 0) {
    text += fmt::format(
        "{} omitted: merged or missing rows; use a source with every row to fill them\n",
        counted(joined.assumed, "quarter-hour"));
  }
  if (joined.constant_days > 0) {
    text += fmt::format("{} with a constant price omitted: zeros until the auction?\n",
                        counted(joined.constant_days, "day"));
  }
  const std::vector<IncompleteDay> incomplete = incomplete_days(series);
  if (incomplete.empty()) return text;
  const IncompleteDay& day = incomplete.front();
  return text + fmt::format("{} incomplete, first {}: {} of {} quarter-hours\n",
                            counted(incomplete.size(), "day"), day.date, day.prices,
                            day.quarter_hours);
}

}  // namespace bess
