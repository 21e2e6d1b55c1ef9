// ENTSO-E's documents of the Transparency Platform (IEC 62325-451-6). A document contains time
// series, these contain periods, these contain points:
//   Period: timeInterval/start, timeInterval/end, resolution (PT15M, PT30M, PT60M)
//   Point:  position (1 = first) and an amount
// curveType A03 omits points that repeat the previous one; with A01 a missing point is a gap.
//
// A85 (Balancing_MarketDocument): settled imbalance prices of other single-price countries.
//   Point:  imbalance_Price.amount, imbalance_Price.category
//           A04 = price of a long party, A05 = of a short one; equal under single pricing
// A44 (Publication_MarketDocument): day-ahead prices, price.amount. A zone with two auctions has a
// series for each, distinguished by classificationSequence_AttributeInstanceComponent.position: 1
// is the coupled day-ahead auction, 2 a local one (Germany, Austria).

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/data/market/feed/day_ahead_rows.h"
#include "workstation/data/market/feed/market_files.h"

namespace bess {
namespace {

struct EntsoeSource {
  std::string_view text;
  std::string_view name;

  /// "a85.xml:17"
  [[nodiscard]] std::string place(std::ptrdiff_t offset) const {
    const std::string_view before = text.substr(0, static_cast<std::size_t>(offset));
    return fmt::format("{}:{}", name, 1 + std::ranges::count(before, '\n'));
  }
};

/// Without a namespace prefix: documents exist with and without.
std::string_view xml_local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);
}

/// Element with its place in the file.
struct EntsoeElement {
  pugi::xml_node node;
  const EntsoeSource& source;

  [[nodiscard]] std::string_view text() const { return node.child_value(); }
  [[nodiscard]] std::string place() const { return source.place(node.offset_debug()); }

  /// The first child with this name, or an element without a node.
  [[nodiscard]] EntsoeElement child(std::string_view name) const {
    const auto named = [name](const pugi::xml_node& n) { return xml_local_name(n) == name; };
    return {node.find_child(named), source};
  }
  [[nodiscard]] EntsoeElement required(std::string_view name) const {
    const EntsoeElement found = child(name);
    if (!found.node) {
      fail("{}: a {} without {}; download the file again", place(), xml_local_name(node), name);
    }
    return found;
  }
  [[nodiscard]] std::vector<EntsoeElement> children(std::string_view name) const {
    std::vector<EntsoeElement> found;
    for (const pugi::xml_node& n : node) {
      if (xml_local_name(n) == name) found.push_back({n, source});
    }
    return found;
  }
};

std::int64_t entsoe_time_of(const EntsoeElement& element) {
  std::int64_t utc_s = 0;
  if (!parse_utc(element.text(), utc_s) || utc_s % kSecondsPerQuarterHour != 0) {
    fail("{}: \"{}\" is not the UTC start of a quarter-hour; download the file again",
         element.place(), one_line(element.text(), 40));
  }
  return utc_s;
}

template <typename Number>
Number entsoe_number_of(const EntsoeElement& element) {
  Number value{};
  if (!read_number(element.text(), value) || !std::isfinite(static_cast<double>(value))) {
    fail("{}: \"{}\" is not a number; download the file again", element.place(),
         one_line(element.text(), 40));
  }
  return value;
}

std::int64_t entsoe_resolution_s_of(const EntsoeElement& element) {
  const std::string_view text = element.text();
  if (text == "PT15M") return 900;
  if (text == "PT30M") return 1800;
  if (text == "PT60M" || text == "PT1H") return 3600;
  fail("{}: resolution \"{}\" is not supported; use PT15M, PT30M or PT60M", element.place(),
       one_line(text, 20));
}

/// Time interval of a Period and its points' steps.
struct EntsoePeriod {
  std::int64_t start_utc_s = 0;
  std::int64_t step_s = 0;
  std::int64_t positions = 0;
};

EntsoePeriod entsoe_period_of(const EntsoeElement& element) {
  const EntsoeElement interval = element.required("timeInterval");
  EntsoePeriod period{.start_utc_s = entsoe_time_of(interval.required("start"))};
  const std::int64_t span_s = entsoe_time_of(interval.required("end")) - period.start_utc_s;
  period.step_s = entsoe_resolution_s_of(element.required("resolution"));
  constexpr std::int64_t kSpanMax_s =
      366LL * kSecondsPerDay;  // the platform returns at most a year
  if (span_s <= 0 || span_s > kSpanMax_s) {
    fail("{}: a period may last up to a year, not {} s; download the file again", interval.place(),
         span_s);
  }
  period.positions = span_s / period.step_s;
  return period;
}

/// Position of a Point in its period, from 1.
std::int64_t entsoe_position_of(const EntsoeElement& point, const EntsoePeriod& period) {
  const auto position = entsoe_number_of<std::int64_t>(point.required("position"));
  if (position < 1 || position > period.positions) {
    fail("{}: position {} is outside its period (they start at 1, end at {}); download it again",
         point.place(), position, period.positions);
  }
  return position;
}

/// Reads a document whose roots are of `kind` (`what` in words). Throws UserError otherwise, also
/// for ENTSO-E's answer without prices.
void load_entsoe_document(pugi::xml_document& document, const EntsoeSource& source,
                          std::string_view kind, std::string_view what) {
  // UTF-8 regardless of the declaration: a conversion would change the offsets.
  const pugi::xml_parse_result parsed = document.load_buffer(
      source.text.data(), source.text.size(), pugi::parse_default, pugi::encoding_utf8);
  // The root of a broken document is more informative than the place of the error.
  for (const pugi::xml_node& root : document) {
    const std::string_view found = xml_local_name(root);
    if (found == kind) continue;
    if (found == "Acknowledgement_MarketDocument") {
      std::string reason;
      for (const pugi::xpath_node& text : root.select_nodes(".//*[local-name()='text']")) {
        reason += std::string(text.node().child_value()) + " ";
      }
      fail("{}: ENTSO-E returned no prices; reason: \"{}\"", source.name, one_line(reason, 200));
    }
    fail("{}: not an ENTSO-E {} but \"{}\"{}", source.name, what, one_line(found, 60),
         found == "Publication_MarketDocument" ? "; import day-ahead prices with --day-ahead" : "");
  }
  if (!parsed) {
    fail("{}: cut short or damaged ({}); download it again", source.place(parsed.offset),
         parsed.description());
  }
}

/// All prices of a TimeSeries must be in EUR/MWh.
void require_entsoe_units(const EntsoeElement& series) {
  for (const auto& [name, wanted] :
       {std::pair{"currency_Unit.name", "EUR"}, std::pair{"price_Measure_Unit.name", "MWH"}}) {
    const EntsoeElement unit = series.child(name);
    if (!unit.node || unit.text() == wanted) continue;
    fail("{}: prices in or per \"{}\" where {} is needed; use an area that publishes EUR per MWH",
         unit.place(), one_line(unit.text(), 20), wanted);
  }
}

/// Refuses a second zone; empty ones are unknown.
void set_entsoe_zone(const EntsoeElement& element, std::string_view named, std::string& zone) {
  if (!zone.empty() && !named.empty() && named != zone) {
    fail("{}: prices of the zone {} after those of {}; import one zone at a time", element.place(),
         one_line(named, 20), one_line(zone, 20));
  }
  if (!named.empty()) zone = named;
}

/// Party to which a price applies; some areas do not state it.
enum Category { kBoth, kLong, kShort, kCategoryCount };

struct Point {
  std::int64_t position = 0;  ///< 1 = first of its period
  double eur_per_mwh = kNotPublished;
  Category category = kBoth;
};

Point point_of(const EntsoeElement& element, const EntsoePeriod& period) {
  Point point{.position = entsoe_position_of(element, period)};
  const EntsoeElement amount = element.child("imbalance_Price.amount");
  if (amount.node) point.eur_per_mwh = entsoe_number_of<double>(amount);
  const std::string_view category = element.child("imbalance_Price.category").text();
  point.category = category == "A04" ? kLong : category == "A05" ? kShort : kBoth;
  return point;
}

void set_price(const Point& point, PartyPrices& prices) {
  if (point.category != kShort) prices.long_eur_per_mwh = point.eur_per_mwh;
  if (point.category != kLong) prices.short_eur_per_mwh = point.eur_per_mwh;
}

using QuarterHourPrices = std::map<std::int64_t, PartyPrices>;  ///< by start, UTC seconds

/// A price of a longer interval applies to each of its quarter-hours; with repeated points it
/// applies until the next of its own category.
void add_period(const EntsoeElement& element, bool repeats, QuarterHourPrices& prices) {
  const EntsoePeriod period = entsoe_period_of(element);
  std::vector<Point> points;
  for (const EntsoeElement& point : element.children("Point")) {
    points.push_back(point_of(point, period));
  }
  // Some documents list all long prices, then all short ones.
  std::ranges::stable_sort(points, {}, &Point::position);
  std::array<std::optional<Point>, kCategoryCount> current;
  auto next = points.begin();
  for (std::int64_t position = 1; position <= period.positions; ++position) {
    if (!repeats) current = {};
    for (; next != points.end() && next->position == position; ++next) {
      current[next->category] = *next;
    }
    const std::int64_t end_utc_s = period.start_utc_s + position * period.step_s;
    for (const std::optional<Point>& point : current) {
      if (!point) continue;
      for (std::int64_t utc_s = end_utc_s - period.step_s; utc_s < end_utc_s;
           utc_s += kSecondsPerQuarterHour) {
        set_price(*point, prices[utc_s]);
      }
    }
  }
}

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

}  // namespace

bool looks_like_xml(std::string_view text) {
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  return first != std::string_view::npos && text[first] == '<';
}

MarketRows parse_entsoe_xml(std::string_view text, std::string_view name) {
  const EntsoeSource source{text, name};
  pugi::xml_document document;
  load_entsoe_document(document, source, "Balancing_MarketDocument", "balancing document (A85)");
  MarketRows rows;
  rows.sources = {MarketSource::kEntsoe};
  QuarterHourPrices prices;
  for (const pugi::xml_node& node : document) {
    const EntsoeElement root{node, source};
    set_entsoe_zone(root, root.child("area_Domain.mRID").text(), rows.zone);
    for (const EntsoeElement& series : root.children("TimeSeries")) {
      require_entsoe_units(series);
      const bool repeats = series.child("curveType").text() == "A03";
      for (const EntsoeElement& period : series.children("Period")) {
        add_period(period, repeats, prices);
      }
    }
  }
  if (prices.empty()) fail("{}: has no imbalance prices; choose other days", name);
  for (const auto& [utc_s, of_parties] : prices) {
    if (of_parties.are_different()) rows.dual_priced_quarter_hours.insert(utc_s);
    rows.quarter_hours.push_back({utc_s, of_parties.single()});
  }
  return rows;
}

DayAheadFile parse_entsoe_day_ahead(std::string_view text, std::string_view name) {
  const EntsoeSource source{text, name};
  pugi::xml_document document;
  load_entsoe_document(document, source, "Publication_MarketDocument",
                       "document of day-ahead prices (A44)");
  DayAheadFile file;
  std::map<std::int64_t, std::vector<DayAheadRow>> rows_of;  ///< by sequence
  for (const pugi::xml_node& root : document) {
    for (const EntsoeElement& series : EntsoeElement{root, source}.children("TimeSeries")) {
      require_entsoe_units(series);
      set_entsoe_zone(series, series.child("out_Domain.mRID").text(), file.zone);
      std::vector<DayAheadRow>& rows = rows_of[sequence_of(series)];
      const bool repeats = series.child("curveType").text() == "A03";
      for (const EntsoeElement& period : series.children("Period")) {
        add_day_ahead_period(period, repeats, rows);
      }
    }
  }
  if (rows_of.empty() || rows_of.begin()->second.empty()) {
    fail("{}: has no day-ahead prices; choose other days", name);
  }
  const std::int64_t first = rows_of.begin()->first;
  file.rows = std::move(rows_of.begin()->second);
  std::size_t unused = 0;
  for (const auto& [sequence, rows] : rows_of) unused += sequence == first ? 0 : rows.size();
  if (unused > 0) {
    file.unused = fmt::format("{} of another auction of the zone (sequence above {}) not used",
                              counted(unused, "price"), first);
  }
  return file;
}

}  // namespace bess
