// ENTSO-E A44 reader (Publication_MarketDocument): time series contain periods, periods contain
// points with a position and a price.amount. With curveType A03 a missing point repeats the
// previous one. A zone with two auctions has a series for each, distinguished by
// classificationSequence_AttributeInstanceComponent.position: 1 is the coupled day-ahead auction, 2
// a local one (Germany, Austria).
#include <algorithm>
#include <limits>

#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/feed/entsoe_element.h"

namespace bess {
namespace {

void add_day_ahead_period(const EntsoeElement& element, bool repeats,
                          std::vector<DayAheadRow>& rows) {
  const EntsoePeriod period = entsoe_period_of(element);
  std::vector<double> prices(static_cast<std::size_t>(period.positions), kNotPublished);
  for (const EntsoeElement& point : element.children("Point")) {
    const std::int64_t position = entsoe_position_of(point, period);
    double& price = prices[static_cast<std::size_t>(position - 1)];
    if (is_published(price)) {
      fail("{}: position {} comes twice; download it again", point.place(), position);
    }
    price = entsoe_number_of<double>(point.required("price.amount"));
  }
  for (std::size_t p = 0; p < prices.size(); ++p) {
    if (repeats && p > 0 && !is_published(prices[p])) prices[p] = prices[p - 1];
    if (!is_published(prices[p])) continue;
    rows.push_back({period.start_utc_s + static_cast<std::int64_t>(p) * period.step_s, prices[p],
                    static_cast<int>(period.step_s / 60)});
  }
}

std::int64_t sequence_of(const EntsoeElement& series) {
  const EntsoeElement position =
      series.child("classificationSequence_AttributeInstanceComponent.position");
  return position.node ? entsoe_number_of<std::int64_t>(position) : 1;
}

struct SequencedRows {
  std::int64_t sequence = 1;
  std::vector<DayAheadRow> rows{};
};

}  // namespace

DayAheadFile parse_entsoe_day_ahead(std::string_view text, std::string_view name) {
  const EntsoeSource source{text, name};
  pugi::xml_document document;
  load_entsoe_document(document, source, "Publication_MarketDocument",
                       "document of day-ahead prices (A44)");
  DayAheadFile file;
  std::vector<SequencedRows> found;
  for (const pugi::xml_node& root : document) {
    for (const EntsoeElement& series : EntsoeElement{root, source}.children("TimeSeries")) {
      require_entsoe_units(series);
      set_entsoe_zone(series, series.child("out_Domain.mRID").text(), file.zone);
      SequencedRows of_series{.sequence = sequence_of(series)};
      const bool repeats = series.child("curveType").text() == "A03";
      for (const EntsoeElement& period : series.children("Period")) {
        add_day_ahead_period(period, repeats, of_series.rows);
      }
      found.push_back(std::move(of_series));
    }
  }
  std::int64_t first = std::numeric_limits<std::int64_t>::max();
  for (const SequencedRows& s : found) first = std::min(first, s.sequence);
  std::size_t unused = 0;
  for (SequencedRows& s : found) {
    if (s.sequence != first) {
      unused += s.rows.size();
      continue;
    }
    file.rows.insert(file.rows.end(), s.rows.begin(), s.rows.end());
  }
  if (file.rows.empty()) fail("{}: has no day-ahead prices; choose other days", name);
  if (unused > 0) {
    file.unused = fmt::format("{} of another auction of the zone (sequence above {}) not used",
                              counted(unused, "price"), first);
  }
  return file;
}

}  // namespace bess
