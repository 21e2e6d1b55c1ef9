#include "workstation/data/market/series/day_ahead.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/local_time.h"
#include "shared/utc_text.h"

namespace bess {

namespace {

constexpr std::int64_t kNever_s = std::numeric_limits<std::int64_t>::max();

std::int64_t usual_publication_utc_s(const LocalDate& delivery, int published_min) {
  const LocalDate before = add_days(delivery, -1);
  return utc_from_local({.year = before.year,
                         .month = before.month,
                         .day = before.day,
                         .hour = published_min / 60,
                         .minute = published_min % 60,
                         .second = 0});
}

constexpr std::string_view kHeader =
    "quarter_hour_utc,day_ahead_eur_mwh,resolution_min,published_utc";
/// Gaps are stored, so a wrong date must not allocate centuries.
constexpr std::int64_t kQuarterHoursMax = 40LL * 366 * 96;

DayAheadRow parse_row(std::string_view line, std::string_view name, std::size_t line_number) {
  const auto bad = [&](std::string_view what) -> void {
    fail("{}:{}: {}: \"{}\"; expected e.g. 2025-06-01T10:00:00Z,41.5,60,", name, line_number, what,
         one_line(line, 80));
  };
  std::string_view time, price, resolution, published, more;
  CsvFields fields(line);
  const bool four = fields.take(time) && fields.take(price) && fields.take(resolution) &&
                    fields.take(published) && !fields.take(more);
  if (!four) bad("not four columns");
  DayAheadRow row{};
  if (!parse_utc(time, row.utc_s, kAlsoBlank) || row.utc_s % kSecondsPerQuarterHour != 0) {
    bad("not the UTC start of a quarter-hour");
  }
  if (!read_number(price, row.eur_per_mwh) || !std::isfinite(row.eur_per_mwh)) {
    bad("price is not a number");
  }
  const bool known =
      read_number(resolution, row.resolution_min) &&
      (row.resolution_min == 15 || row.resolution_min == 30 || row.resolution_min == 60);
  if (!known) bad("resolution is not 15, 30 or 60 minutes");
  if (!published.empty() && !parse_utc(published, row.published_utc_s, kAlsoBlank)) {
    bad("not the UTC time of its publication");
  }
  return row;
}

}  // namespace

DayAheadPublication::DayAheadPublication(DayAheadSeries series, int published_min)
    : series_(std::move(series)) {
  known_utc_s_.reserve(series_.size());
  std::int64_t day_end = std::numeric_limits<std::int64_t>::min();
  std::int64_t usual = 0;
  for (std::size_t q = 0; q < series_.size(); ++q) {
    if (series_.utc_s(q) >= day_end) {
      const LocalDate delivery = local_date_of(series_.utc_s(q));
      day_end = local_midnight_utc_s(add_days(delivery, 1));
      usual = usual_publication_utc_s(delivery, published_min);
    }
    known_utc_s_.push_back(is_published(series_.eur_per_mwh[q])
                               ? std::max(usual, series_.published_utc_s[q])
                               : kNever_s);
  }
}

double DayAheadPublication::known_eur_per_mwh(std::int64_t utc_s, std::int64_t now_utc_s) const {
  if (utc_s < series_.start_utc_s || utc_s >= series_.end_utc_s()) return kNotPublished;
  const auto q = static_cast<std::size_t>((utc_s - series_.start_utc_s) / kSecondsPerQuarterHour);
  return known_utc_s_[q] <= now_utc_s ? series_.eur_per_mwh[q] : kNotPublished;
}

std::int64_t DayAheadPublication::next_known_utc_s(std::int64_t from_utc_s,
                                                   std::int64_t until_utc_s,
                                                   std::int64_t now_utc_s) const {
  std::int64_t next = kNever_s;
  const std::int64_t from = std::max(from_utc_s, series_.start_utc_s);
  const std::int64_t until = std::min(until_utc_s, series_.end_utc_s());
  for (std::int64_t utc_s = from; utc_s < until; utc_s += kSecondsPerQuarterHour) {
    const auto q = static_cast<std::size_t>((utc_s - series_.start_utc_s) / kSecondsPerQuarterHour);
    if (known_utc_s_[q] > now_utc_s) next = std::min(next, known_utc_s_[q]);
  }
  return next;
}

bool append_day_ahead(DayAheadSeries& series, const DayAheadRow& price) {
  if (series.size() == 0) series.start_utc_s = price.utc_s;
  const std::int64_t index = (price.utc_s - series.start_utc_s) / kSecondsPerQuarterHour;
  if (index < static_cast<std::int64_t>(series.size()) || index >= kQuarterHoursMax) return false;
  const auto missing = static_cast<std::size_t>(index);
  series.eur_per_mwh.resize(missing, kNotPublished);
  series.resolution_min.resize(missing, 0);
  series.published_utc_s.resize(missing, 0);
  series.eur_per_mwh.push_back(price.eur_per_mwh);
  series.resolution_min.push_back(static_cast<std::uint8_t>(price.resolution_min));
  series.published_utc_s.push_back(price.published_utc_s);
  return true;
}

bool is_day_ahead_csv(std::string_view text) { return csv_header(text) == kHeader; }

DayAheadSeries parse_day_ahead_csv(std::string_view text, std::string_view name) {
  text = plain_text(text, name);
  DayAheadSeries series;
  bool header_seen = false;
  for (std::size_t line_number = 1; !text.empty(); ++line_number) {
    const std::string_view line = take_line(text);
    if (line.empty() || line[0] == '#') continue;
    if (!header_seen) {
      if (line != kHeader) {
        fail(
            "{}:{}: not a day-ahead file: the header must be \"{}\"; convert downloads with "
            "'bess-train prices import --day-ahead'",
            name, line_number, kHeader);
      }
      header_seen = true;
      continue;
    }
    if (!append_day_ahead(series, parse_row(line, name, line_number))) {
      fail(
          "{}:{}: row out of order, or 40 years after the first; sort the file by time, remove "
          "duplicates: \"{}\"",
          name, line_number, one_line(line, 80));
    }
  }
  if (series.size() == 0) fail("{}: has no day-ahead prices", name);
  return series;
}

std::string format_day_ahead_csv(const DayAheadSeries& series, std::string_view provenance) {
  std::string text = comment_lines(provenance);
  text.append(kHeader).append("\n");
  for (std::size_t q = 0; q < series.size(); ++q) {
    if (!is_published(series.eur_per_mwh[q])) continue;
    text += fmt::format("{},{},{},", utc_text(series.utc_s(q)).view(), series.eur_per_mwh[q],
                        series.resolution_min[q]);
    if (series.published_utc_s[q] != 0) text += utc_text(series.published_utc_s[q]).view();
    text += '\n';
  }
  return text;
}

void write_day_ahead_file(const std::filesystem::path& path, const DayAheadSeries& series,
                          std::string_view provenance) {
  write_file(path, format_day_ahead_csv(series, provenance));
}

std::vector<IncompleteDay> incomplete_days(const DayAheadSeries& series) {
  std::vector<IncompleteDay> incomplete;
  if (series.size() == 0) return incomplete;
  for (LocalDate date = local_date_of(series.start_utc_s);
       local_midnight_utc_s(date) < series.end_utc_s(); date = add_days(date, 1)) {
    const std::int64_t from = local_midnight_utc_s(date);
    const std::int64_t until = local_midnight_utc_s(add_days(date, 1));
    std::size_t prices = 0;
    for (std::int64_t utc_s = from; utc_s < until; utc_s += kSecondsPerQuarterHour) {
      const std::int64_t q = (utc_s - series.start_utc_s) / kSecondsPerQuarterHour;
      const bool inside = utc_s >= series.start_utc_s && utc_s < series.end_utc_s();
      prices += inside && is_published(series.eur_per_mwh[static_cast<std::size_t>(q)]) ? 1 : 0;
    }
    const auto all = static_cast<std::size_t>((until - from) / kSecondsPerQuarterHour);
    if (prices < all) incomplete.push_back({format_local_date(date), prices, all});
  }
  return incomplete;
}

}  // namespace bess
