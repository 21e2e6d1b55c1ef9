#include "workstation/market/feed/market_minutes.h"

#include <algorithm>

#include "shared/host/csv.h"
#include "shared/host/minute_file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

/// By what the comments at the head say; the words are those of attribution_of() and of the
/// commands.
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
    fail("{}: the quarter-hour of {} has two settled prices, {} and {}; mend the file", name,
         utc_text(start_utc_s).view(), quarter_hours.back().price_eur_per_mwh, price);
  }
}

}  // namespace

bool is_spreadsheet_minute_csv(std::string_view text) {
  std::string header(csv_header(text));
  if (header.find(';') == header.npos) return false;
  std::ranges::replace(header, ';', ',');
  return is_minute_csv(header);
}

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

}  // namespace bess
