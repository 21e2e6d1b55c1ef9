#include "workstation/market/feed/day_ahead_rows.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>

#include "shared/host/csv.h"
#include "shared/host/json.h"
#include "shared/host/plain_text.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "workstation/market/feed/entsoe_xml.h"
#include "workstation/market/feed/market_rows.h"
#include "workstation/market/series/local_date.h"

namespace bess {
namespace {

/// Seconds that no calendar here reaches: 2200-01-01.
constexpr double kUnixSecondsMax = 7'258'118'400;

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

/// "1,5" is a number where semicolons separate the fields.
bool parse_decimal(std::string_view field, char separator, double& value) {
  std::string text(field);
  if (separator == ';') std::ranges::replace(text, ',', '.');
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc{} && end == text.data() + text.size() && std::isfinite(value);
}

DayAheadRow tidy_row(std::string_view line, const TidyColumns& columns, const std::string& place) {
  std::vector<std::string_view> fields;
  CsvFields taken(line, columns.separator);
  for (std::string_view field; taken.take(field);) fields.push_back(field);
  if (fields.size() != columns.count) {
    fail("{}: {} columns where the header has {}; the file may be cut short, get it again", place,
         fields.size(), columns.count);
  }
  DayAheadRow row{};
  if (!parse_utc(fields[*columns.time], row.utc_s, kAlsoBlank)) {
    fail("{}: \"{}\" is no time with Z or an offset, e.g. 2025-06-01T10:00:00Z", place,
         one_line(fields[*columns.time], 40));
  }
  const std::string_view price = fields[*columns.price];
  row.eur_per_mwh = kNotPublished;
  if (!price.empty() && !parse_decimal(price, columns.separator, row.eur_per_mwh)) {
    fail("{}: \"{}\" is not a price", place, one_line(price, 40));
  }
  double resolution = 0;
  if (columns.resolution && parse_decimal(fields[*columns.resolution], ',', resolution)) {
    row.resolution_min =
        resolution == 15 || resolution == 30 || resolution == 60 ? static_cast<int>(resolution) : 0;
  }
  if (columns.published && !fields[*columns.published].empty() &&
      !parse_utc(fields[*columns.published], row.published_utc_s, kAlsoBlank)) {
    fail("{}: \"{}\" is no time of publication; leave it empty where nobody noted it", place,
         one_line(fields[*columns.published], 40));
  }
  return row;
}

/// By local day, in order of time.
using RowsByDay = std::map<LocalDate, std::vector<DayAheadRow>>;

/// Seconds that each price of a day holds; 0 when they do not come every 15, 30 or 60 minutes.
std::int64_t step_of_day(const std::vector<DayAheadRow>& day) {
  const std::int64_t said_s = 60 * std::int64_t{day.front().resolution_min};
  if (day.size() < 2) return said_s;
  std::int64_t step_s = day[1].utc_s - day[0].utc_s;
  for (std::size_t r = 1; r < day.size(); ++r) {
    step_s = std::min(step_s, day[r].utc_s - day[r - 1].utc_s);
  }
  if (said_s != 0) step_s = std::min(step_s, said_s);  // longer where a price is missing
  return step_s == 900 || step_s == 1800 || step_s == 3600 ? step_s : 0;
}

/// A day of quarter-hours is one of hours when each of its hours, and there are many, has one
/// price.
bool are_repeated_hours(const std::vector<DayAheadRow>& day) {
  constexpr std::size_t kHoursMin = 20;
  std::map<std::int64_t, std::vector<double>> hours;
  for (const DayAheadRow& row : day) {
    if (is_published(row.eur_per_mwh)) hours[row.utc_s / 3600].push_back(row.eur_per_mwh);
  }
  std::size_t whole = 0;
  for (const auto& [hour, prices] : hours) {
    if (std::ranges::adjacent_find(prices, std::not_equal_to<>{}) != prices.end()) return false;
    whole += prices.size() == 4 ? 1 : 0;
  }
  return whole >= kHoursMin;
}

/// Sorted and without doubles; later rows of the list win.
RowsByDay by_day(std::vector<DayAheadRow> rows, std::string_view name,
                 std::vector<Finding>& findings) {
  std::ranges::stable_sort(rows, {}, &DayAheadRow::utc_s);
  RowsByDay days;
  std::vector<DayAheadRow> distinct;
  for (const DayAheadRow& row : rows) {
    if (row.utc_s % kSecondsPerQuarterHour != 0) {
      fail("{}: {} is not the start of a quarter-hour; mend the times", name,
           utc_text(row.utc_s).view());
    }
    if (distinct.empty() || distinct.back().utc_s != row.utc_s) {
      distinct.push_back(row);
      continue;
    }
    if (!is_published(row.eur_per_mwh)) continue;
    const bool disagree =
        is_published(distinct.back().eur_per_mwh) && distinct.back().eur_per_mwh != row.eur_per_mwh;
    if (disagree && findings.empty()) {
      findings.push_back({"overlap", true,
                          fmt::format("two day-ahead prices of one time, {} and {}: which is it? "
                                      "the later one counts when it is accepted",
                                      distinct.back().eur_per_mwh, row.eur_per_mwh),
                          row.utc_s});
    }
    distinct.back() = row;
  }
  for (const DayAheadRow& row : distinct) days[local_date_of(row.utc_s)].push_back(row);
  return days;
}

}  // namespace

std::vector<DayAheadRow> parse_tidy_day_ahead(std::string_view text, std::string_view name) {
  text = plain_text(text, name);
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
  if (!columns) fail("{}: the file is empty; get it again", name);
  return rows;
}

std::vector<DayAheadRow> parse_energy_charts(std::string_view text, std::string_view name) {
  const Json json = Json::parse(text);
  const JsonValue times = json.value()["unix_seconds"];
  const JsonValue prices = json.value()["price"];
  if (!times.is_list() || !prices.is_list() || times.size() != prices.size()) {
    fail(
        "{}: no day-ahead prices of energy-charts (unix_seconds and price, one of each), or cut "
        "short; get it again",
        name);
  }
  const JsonValue unit = json.value()["unit"];
  if (unit.exists() && plain_name(unit.text_or("")) != "eurmwh") {
    fail("{}: prices in \"{}\" where EUR / MWh is needed; use an area that publishes it", name,
         one_line(unit.text_or(""), 20));
  }
  std::vector<DayAheadRow> rows;
  auto price = prices.begin();
  for (const JsonValue time : times) {
    const std::optional<double> utc_s = time.number();
    const JsonValue of_time = *price;
    ++price;
    if (!utc_s || !(*utc_s >= 0 && *utc_s < kUnixSecondsMax) || std::floor(*utc_s) != *utc_s) {
      fail("{}: unix_seconds[{}] is no time; get it again", name, rows.size());
    }
    if (!of_time.is_null() && !of_time.number()) {
      fail("{}: price[{}] is not a number; get it again", name, rows.size());
    }
    rows.push_back({static_cast<std::int64_t>(*utc_s), of_time.number().value_or(kNotPublished)});
  }
  return rows;
}

std::vector<DayAheadRow> parse_day_ahead_text(std::string_view text, std::string_view name) {
  if (looks_like_xml(text)) return parse_entsoe_day_ahead(text, name);
  return looks_like_json(text) ? parse_energy_charts(text, name) : parse_tidy_day_ahead(text, name);
}

JoinedDayAhead join_day_ahead(std::vector<DayAheadRow> rows, std::string_view name) {
  JoinedDayAhead joined;
  for (const auto& [date, day] : by_day(std::move(rows), name, joined.findings)) {
    const std::int64_t step_s = step_of_day(day);
    if (step_s == 0) {
      fail(
          "{}: the day-ahead prices of {} do not come every 15, 30 or 60 minutes ({}); get the day "
          "again",
          name, format_local_date(date), counted(day.size(), "row"));
    }
    const bool repeated = step_s == kSecondsPerQuarterHour && are_repeated_hours(day);
    const int said_min = day.front().resolution_min;
    const int resolution_min = repeated ? 60 : std::max(said_min, static_cast<int>(step_s / 60));
    const std::int64_t midnight_utc_s = local_midnight_utc_s(add_days(date, 1));
    for (std::size_t r = 0; r < day.size(); ++r) {
      if (!is_published(day[r].eur_per_mwh)) continue;
      const std::int64_t end_utc_s = r + 1 < day.size()
                                         ? std::min(day[r].utc_s + step_s, day[r + 1].utc_s)
                                         : std::min(day[r].utc_s + step_s, midnight_utc_s);
      for (std::int64_t utc_s = day[r].utc_s; utc_s < end_utc_s; utc_s += kSecondsPerQuarterHour) {
        const DayAheadPrice price{utc_s, day[r].eur_per_mwh, resolution_min,
                                  day[r].published_utc_s};
        if (!append_day_ahead(joined.series, price)) {
          fail("{}: {} lies more than 40 years behind the first row; mend the date", name,
               utc_text(utc_s).view());
        }
      }
    }
    if (resolution_min == 60) joined.repeated_hours += step_s == 900 ? day.size() / 4 : day.size();
  }
  if (joined.series.size() == 0) fail("{}: holds no day-ahead prices; choose other days", name);
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
  const std::vector<IncompleteDay> incomplete = incomplete_days(series);
  if (incomplete.empty()) return text;
  const IncompleteDay& day = incomplete.front();
  return text + fmt::format("{} not complete, first {}: {} of {} quarter-hours\n",
                            counted(incomplete.size(), "day"), day.date, day.prices,
                            day.quarter_hours);
}

}  // namespace bess
