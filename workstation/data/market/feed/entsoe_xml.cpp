// ENTSO-E A85 reader: settled imbalance prices of other single-price countries from the
// Transparency Platform (Balancing_MarketDocument, IEC 62325-451-6). A document contains time
// series, these contain periods, these contain points:
//   Period: timeInterval/start, timeInterval/end, resolution (PT15M, PT30M, PT60M)
//   Point:  position (1 = first), imbalance_Price.amount, imbalance_Price.category
//           A04 = price of a long party, A05 = of a short one; equal under single pricing
// curveType A03 omits points that repeat the previous one; with A01 a missing point is a gap.

#include <algorithm>
#include <array>
#include <map>
#include <optional>
#include <vector>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/data/market/feed/entsoe_element.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

/// Party to which a price applies; some areas do not state it.
enum Category { kBoth, kLong, kShort, kCategoryCount };

struct Point {
  std::int64_t position = 0;  ///< 1 = first of its period
  double eur_per_mwh = kNotPublished;
  Category category = kBoth;
};

struct Period {
  EntsoePeriod time;
  std::vector<Point> points{};  ///< by position
};

Point point_of(const EntsoeElement& element, const EntsoePeriod& period) {
  Point point{.position = entsoe_position_of(element, period)};
  const EntsoeElement amount = element.child("imbalance_Price.amount");
  if (amount.node) point.eur_per_mwh = entsoe_number_of<double>(amount);
  const std::string_view category = element.child("imbalance_Price.category").text();
  point.category = category == "A04" ? kLong : category == "A05" ? kShort : kBoth;
  return point;
}

Period period_of(const EntsoeElement& element) {
  Period period{entsoe_period_of(element)};
  for (const EntsoeElement& point : element.children("Point")) {
    period.points.push_back(point_of(point, period.time));
  }
  // Some documents list all long prices, then all short ones.
  std::ranges::stable_sort(period.points, {}, &Point::position);
  return period;
}

struct Prices {
  double long_eur_per_mwh = kNotPublished;
  double short_eur_per_mwh = kNotPublished;

  void set(const Point& point) {
    if (point.category != kShort) long_eur_per_mwh = point.eur_per_mwh;
    if (point.category != kLong) short_eur_per_mwh = point.eur_per_mwh;
  }
  [[nodiscard]] bool are_different() const {
    return is_published(long_eur_per_mwh) && is_published(short_eur_per_mwh) &&
           long_eur_per_mwh != short_eur_per_mwh;
  }
  /// The common price; NaN if there are two different ones, or none.
  [[nodiscard]] double single() const {
    if (!is_published(long_eur_per_mwh)) return short_eur_per_mwh;
    if (!is_published(short_eur_per_mwh)) return long_eur_per_mwh;
    return are_different() ? kNotPublished : long_eur_per_mwh;
  }
};
using QuarterHourPrices = std::map<std::int64_t, Prices>;  ///< by start, UTC seconds

/// A price of a longer interval applies to each of its quarter-hours; with repeated points it
/// applies until the next of its own category.
void add_period(const Period& period, bool repeats, QuarterHourPrices& prices) {
  std::array<std::optional<Point>, kCategoryCount> current;
  auto next = period.points.begin();
  for (std::int64_t position = 1; position <= period.time.positions; ++position) {
    if (!repeats) current = {};
    for (; next != period.points.end() && next->position == position; ++next) {
      current[next->category] = *next;
    }
    const std::int64_t end_utc_s = period.time.start_utc_s + position * period.time.step_s;
    for (const std::optional<Point>& point : current) {
      if (!point) continue;
      for (std::int64_t utc_s = end_utc_s - period.time.step_s; utc_s < end_utc_s;
           utc_s += kSecondsPerQuarterHour) {
        prices[utc_s].set(*point);
      }
    }
  }
}

void add_series(const EntsoeElement& series, QuarterHourPrices& prices) {
  require_entsoe_units(series);
  const bool repeats = series.child("curveType").text() == "A03";
  for (const EntsoeElement& period : series.children("Period")) {
    add_period(period_of(period), repeats, prices);
  }
}

QuarterHourPrices prices_of(const EntsoeSource& source, std::string& zone) {
  pugi::xml_document document;
  load_entsoe_document(document, source, "Balancing_MarketDocument", "balancing document (A85)");
  QuarterHourPrices prices;
  for (const pugi::xml_node& node : document) {
    const EntsoeElement root{node, source};
    set_entsoe_zone(root, root.child("area_Domain.mRID").text(), zone);
    for (const EntsoeElement& series : root.children("TimeSeries")) add_series(series, prices);
  }
  if (prices.empty()) fail("{}: has no imbalance prices; choose other days", source.name);
  return prices;
}

}  // namespace

bool looks_like_xml(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

MarketRows parse_entsoe_xml(std::string_view text, std::string_view name) {
  MarketRows rows;
  rows.sources = {MarketSource::kEntsoe};
  for (const auto& [utc_s, prices] : prices_of({text, name}, rows.zone)) {
    QuarterHour quarter_hour;
    quarter_hour.utc_s = utc_s;
    quarter_hour.price_eur_per_mwh = prices.single();
    if (prices.are_different()) rows.dual_priced_quarter_hours.insert(utc_s);
    rows.quarter_hours.push_back(quarter_hour);
  }
  return rows;
}

}  // namespace bess
