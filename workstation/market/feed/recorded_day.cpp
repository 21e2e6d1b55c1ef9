#include "workstation/market/feed/recorded_day.h"

#include <fmt/core.h>

#include <algorithm>
#include <limits>
#include <set>

#include "shared/host/csv.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::string_view kHeader =
    "minute_utc,price_eur_mwh,system_imbalance_mw,price_arrived_utc,imbalance_arrived_utc,"
    "quality_status,arrival";
enum Column : std::size_t {
  kMinuteColumn,
  kPriceColumn,
  kImbalanceColumn,
  kPriceArrivedColumn,
  kImbalanceArrivedColumn,
  kQualityColumn,
  kArrivalColumn
};
constexpr std::string_view kSeen = "seen";
constexpr std::string_view kFound = "found";

std::string value_text(const std::optional<RecordedValue>& value) {
  return value && is_published(value->value) ? fmt::format("{}", value->value) : std::string();
}

std::string arrival_text(const std::optional<RecordedValue>& value) {
  return value ? std::string(utc_text(value->arrived_utc_s).view()) : std::string();
}

/// True of a line whose last column is there to its end.
bool is_whole(std::string_view line) {
  const std::size_t comma = line.rfind(',');
  if (comma == line.npos) return false;
  const std::string_view arrival = line.substr(comma + 1);
  return arrival == kSeen || arrival == kFound;
}

std::optional<RecordedValue> recorded_value(const CsvTable& table, std::size_t row, Column value,
                                            Column arrived) {
  if (table.text(row, arrived).empty()) return std::nullopt;
  const bool published = !table.text(row, value).empty();
  return RecordedValue{published ? table.number(row, value) : kNotPublished,
                       table.utc_s(row, arrived)};
}

RecordedLine recorded_line(const CsvTable& table, std::size_t row, std::string_view name) {
  RecordedLine line;
  line.minute_utc_s = table.utc_s(row, kMinuteColumn);
  line.price_eur_per_mwh = recorded_value(table, row, kPriceColumn, kPriceArrivedColumn);
  line.system_imbalance_mw = recorded_value(table, row, kImbalanceColumn, kImbalanceArrivedColumn);
  line.quality = std::string_view(table.text(row, kQualityColumn));
  line.seen = table.text(row, kArrivalColumn) == kSeen;
  for (const auto& value : {line.price_eur_per_mwh, line.system_imbalance_mw}) {
    if (!value || value->arrived_utc_s >= line.minute_utc_s + 60) continue;
    fail(
        "{}: the line of {}: arrived at {}, before its minute had ended: the clock of the recorder "
        "or of the source was wrong; leave the file out",
        name, table.text(row, kMinuteColumn), utc_text(value->arrived_utc_s).view());
  }
  if (line.minute_utc_s % 60 != 0 || (!line.seen && table.text(row, kArrivalColumn) != kFound)) {
    fail(
        "{}: the line of {}: not a whole minute, or its arrival is neither {} nor {}; mend the "
        "file",
        name, table.text(row, kMinuteColumn), kSeen, kFound);
  }
  return line;
}

/// Calls `take` for the first price of each minute.
template <typename Take>
void for_first_prices(const std::vector<RecordedLine>& lines, Take take) {
  std::set<std::int64_t> minutes;
  for (const RecordedLine& line : lines) {
    const auto& price = line.price_eur_per_mwh;
    if (!price || !is_published(price->value)) continue;
    if (minutes.insert(line.minute_utc_s).second) take(line);
  }
}

}  // namespace

std::string recorded_head(std::string_view provenance) {
  return comment_lines(provenance).append(kHeader).append("\n");
}

std::string format_recorded_line(const RecordedLine& line) {
  return fmt::format("{},{},{},{},{},{},{}\n", utc_text(line.minute_utc_s).view(),
                     value_text(line.price_eur_per_mwh), value_text(line.system_imbalance_mw),
                     arrival_text(line.price_eur_per_mwh), arrival_text(line.system_imbalance_mw),
                     csv_field(line.quality.view()), line.seen ? kSeen : kFound);
}

bool is_recorded_csv(std::string_view text) { return csv_header(text) == kHeader; }

WholePart whole_part(std::string_view text) {
  text = text.substr(0, text.find('\0'));  // a power cut may leave zeros where a line was to be
  const std::size_t end = text.rfind('\n') + 1;  // 0 when there is none
  if (is_whole(text.substr(end))) return {text, true};
  return {text.substr(0, end), false};
}

std::vector<RecordedLine> parse_recorded_day(std::string_view text, std::string_view name) {
  text = whole_part(text).text;
  std::vector<RecordedLine> lines;
  if (text.empty() || text.ends_with(std::string(kHeader) + "\n")) return lines;
  const CsvTable table(text, std::string(name), kHeader);
  lines.reserve(table.row_count());
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    lines.push_back(recorded_line(table, row, name));
  }
  return lines;
}

MarketRows parse_recorded_rows(std::string_view text, std::string_view name) {
  MarketRows rows;
  rows.sources.insert(MarketSource::kElia);
  for_first_prices(parse_recorded_day(text, name), [&rows](const RecordedLine& line) {
    rows.minutes.push_back({line.minute_utc_s, line.price_eur_per_mwh->value});
  });
  return rows;
}

void LatenessTally::add(std::int64_t minute_utc_s, std::int64_t arrived_utc_s, bool seen) {
  if (!seen) {
    ++found_;
    return;
  }
  constexpr std::int64_t kMost = std::numeric_limits<std::int32_t>::max();
  const std::int64_t late_s = std::clamp(arrived_utc_s - (minute_utc_s + 60), -kMost, kMost);
  late_s_.push_back(static_cast<std::int32_t>(late_s));
}

Lateness LatenessTally::result() const {
  Lateness lateness{.seen = late_s_.size(), .found = found_};
  if (late_s_.empty()) return lateness;
  std::vector<std::int32_t> sorted = late_s_;
  std::ranges::sort(sorted);
  const auto nearest_rank = [&sorted](std::size_t percent) {
    return static_cast<double>(sorted[(sorted.size() * percent + 99) / 100 - 1]);
  };
  lateness.median_s = nearest_rank(50);
  lateness.p95_s = nearest_rank(95);
  return lateness;
}

Lateness lateness_of(const std::vector<RecordedLine>& lines) {
  LatenessTally tally;
  for_first_prices(lines, [&tally](const RecordedLine& line) {
    tally.add(line.minute_utc_s, line.price_eur_per_mwh->arrived_utc_s, line.seen);
  });
  return tally.result();
}

std::string describe_lateness(const Lateness& lateness) {
  std::string text;
  if (lateness.seen > 0) {
    text = fmt::format(
        "{} seen to arrive: median {:.0f} s after the minute's end, 95 % within {:.0f} s\n",
        counted(lateness.seen, "price"), lateness.median_s, lateness.p95_s);
  }
  if (lateness.found > 0) {
    text += fmt::format("{} found: there when one looked, so of unknown arrival\n",
                        counted(lateness.found, "price"));
  }
  return text;
}

}  // namespace bess
