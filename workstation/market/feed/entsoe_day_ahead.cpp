// ENTSO-E A44 (Publication_MarketDocument): time series, of these periods, of these points with a
// position and a price.amount. Under curveType A03 a point that is left out repeats the one before.
#include <algorithm>

#include "workstation/market/feed/day_ahead_rows.h"
#include "workstation/market/feed/entsoe_element.h"

namespace bess {
namespace {

void add_day_ahead_period(const EntsoeElement& element, bool repeats,
                          std::vector<DayAheadRow>& rows) {
  const EntsoeElement interval = element.required("timeInterval");
  const std::int64_t start_utc_s = entsoe_time_of(interval.required("start"));
  const std::int64_t span_s = entsoe_time_of(interval.required("end")) - start_utc_s;
  const std::int64_t step_s = entsoe_resolution_s_of(element.required("resolution"));
  if (span_s <= 0 || span_s > kEntsoePeriodSecondsMax) {
    fail("{}: a period may last up to a year, not {} s; download the file again", interval.place(),
         span_s);
  }
  std::vector<double> prices(static_cast<std::size_t>(span_s / step_s), kNotPublished);
  for (const EntsoeElement& point : element.children("Point")) {
    const auto position = entsoe_number_of<std::int64_t>(point.required("position"));
    if (position < 1 || position > static_cast<std::int64_t>(prices.size())) {
      fail("{}: position {} is outside its period (they start at 1, end at {}); download it again",
           point.place(), position, prices.size());
    }
    double& price = prices[static_cast<std::size_t>(position - 1)];
    if (is_published(price)) {
      fail("{}: position {} comes twice; download it again", point.place(), position);
    }
    price = entsoe_number_of<double>(point.required("price.amount"));
  }
  for (std::size_t p = 0; p < prices.size(); ++p) {
    if (repeats && p > 0 && !is_published(prices[p])) prices[p] = prices[p - 1];
    if (!is_published(prices[p])) continue;
    rows.push_back({start_utc_s + static_cast<std::int64_t>(p) * step_s, prices[p],
                    static_cast<int>(step_s / 60)});
  }
}

}  // namespace

std::vector<DayAheadRow> parse_entsoe_day_ahead(std::string_view text, std::string_view name) {
  const EntsoeSource source{text, name};
  pugi::xml_document document;
  load_entsoe_document(document, source, "Publication_MarketDocument",
                       "document of day-ahead prices (A44)");
  std::vector<DayAheadRow> rows;
  for (const pugi::xml_node& root : document) {
    for (const EntsoeElement& series : EntsoeElement{root, source}.children("TimeSeries")) {
      require_entsoe_unit(series.child("currency_Unit.name"), "EUR");
      require_entsoe_unit(series.child("price_Measure_Unit.name"), "MWH");
      const bool repeats = series.child("curveType").text() == "A03";
      for (const EntsoeElement& period : series.children("Period")) {
        add_day_ahead_period(period, repeats, rows);
      }
    }
  }
  if (rows.empty()) fail("{}: holds no day-ahead prices; choose other days", name);
  return rows;
}

}  // namespace bess
