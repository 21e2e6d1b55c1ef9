#include "shared/host/minute_file.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
constexpr std::string_view kHeader = "minute_utc,indicative_eur_mwh,settled_eur_mwh";
/// Gaps are stored as missing minutes, so a wrong date must not allocate centuries.
constexpr std::int64_t kMinutesMax = 40LL * 366 * 24 * 60;

/// Price field: empty means missing, else one finite number.
bool parse_price(std::string_view field, double& value) {
  if (field.empty()) {
    value = kMissing;
    return true;
  }
  return read_number(field, value) && std::isfinite(value);
}

struct Row {
  std::int64_t utc_s;
  double indicative;
  double settled;
};

Row parse_row(std::string_view line, std::string_view name, std::size_t line_number) {
  const auto bad = [&](std::string_view what) -> void {
    fail("{}:{}: {}: \"{}\"; expected e.g. 2023-01-01T00:00:00Z,10.71,-11.28", name, line_number,
         what, one_line(line, 80));
  };
  const std::size_t comma1 = line.find(',');
  const std::size_t comma2 = comma1 == line.npos ? line.npos : line.find(',', comma1 + 1);
  if (comma2 == line.npos || line.find(',', comma2 + 1) != line.npos) bad("not three columns");
  Row row{};
  if (!parse_utc(line.substr(0, comma1), row.utc_s, kAlsoBlank)) bad("not a UTC minute");
  if (row.utc_s % 60 != 0) bad("not a whole minute");
  if (!parse_price(line.substr(comma1 + 1, comma2 - comma1 - 1), row.indicative)) {
    bad("indicative price is not a number");
  }
  if (!parse_price(line.substr(comma2 + 1), row.settled)) bad("settled price is not a number");
  return row;
}

void append_row(MinuteSeries& series, const Row& row, std::string_view name,
                std::size_t line_number) {
  if (series.settled.empty()) series.start_utc_s = row.utc_s;
  const std::int64_t index = (row.utc_s - series.start_utc_s) / 60;
  const auto size = static_cast<std::int64_t>(series.size());
  if (index < size) {
    fail(
        "{}:{}: row out of order: {} is not after {}; sort the file by time and remove "
        "duplicates",
        name, line_number, utc_text(row.utc_s).view(),
        utc_text(series.utc_s(series.size() - 1)).view());
  }
  if (index >= kMinutesMax) {
    fail("{}:{}: {} is more than 40 years after the first row; correct the date", name, line_number,
         utc_text(row.utc_s).view());
  }
  series.indicative.resize(static_cast<std::size_t>(index), kMissing);
  series.settled.resize(static_cast<std::size_t>(index), kMissing);
  series.indicative.push_back(row.indicative);
  series.settled.push_back(row.settled);
}

}  // namespace

bool has_no_price(std::span<const double> prices) {
  return std::ranges::all_of(prices, [](double price) { return std::isnan(price); });
}

bool is_minute_csv(std::string_view text) { return csv_header(text) == kHeader; }

MinuteSeries parse_minute_csv(std::string_view text, std::string_view name) {
  text = plain_text(text, name);
  MinuteSeries series;
  std::size_t line_number = 0;
  bool header_seen = false;
  bool has_price = false;
  while (!text.empty()) {
    const std::string_view line = take_line(text);
    ++line_number;
    if (line.empty() || line[0] == '#') continue;
    if (!header_seen) {
      if (line != kHeader) {
        fail(
            "{}:{}: not a minute file: the header must be \"{}\"; convert downloads with "
            "'bess-train prices import'",
            name, line_number, kHeader);
      }
      header_seen = true;
      continue;
    }
    const Row row = parse_row(line, name, line_number);
    append_row(series, row, name, line_number);
    has_price = has_price || !std::isnan(row.indicative) || !std::isnan(row.settled);
  }
  if (series.settled.empty()) fail("{}: has no minutes", name);
  if (!has_price) fail("{}: has minutes but no prices", name);
  return series;
}

MinuteSeries read_minute_file(const std::filesystem::path& path) {
  return parse_minute_csv(read_file(path), path.string());
}

std::string format_minute_csv(const MinuteSeries& series, std::string_view provenance) {
  std::string text = comment_lines(provenance);
  text.append(kHeader).append("\n");
  const auto append_price = [&text](double price) {
    if (!std::isnan(price)) text.append(fmt::format("{}", price));
  };
  for (std::size_t m = 0; m < series.size(); ++m) {
    if (series.is_empty(m)) continue;
    text.append(utc_text(series.utc_s(m)).view()).append(",");
    append_price(series.indicative[m]);
    text += ',';
    append_price(series.settled[m]);
    text += '\n';
  }
  return text;
}

void write_minute_file(const std::filesystem::path& path, const MinuteSeries& series,
                       std::string_view provenance) {
  write_file(path, format_minute_csv(series, provenance));
}

}  // namespace bess
