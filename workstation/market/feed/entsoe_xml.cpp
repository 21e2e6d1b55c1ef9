#include "workstation/market/feed/entsoe_xml.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <pugixml.hpp>
#include <string>
#include <vector>

#include "shared/host/minute_file.h"
#include "shared/host/plain_text.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kPeriodSecondsMax = 366LL * 86'400;  // the platform answers a year at most

struct Source {
  std::string_view text;
  std::string_view name;

  /// "a85.xml:17"
  [[nodiscard]] std::string place(std::ptrdiff_t offset) const {
    const std::string_view before = text.substr(0, static_cast<std::size_t>(offset));
    return fmt::format("{}:{}", name, 1 + std::ranges::count(before, '\n'));
  }
};

/// Without the prefix of its namespace: documents come with and without one.
std::string_view local_name(const pugi::xml_node& node) {
  const std::string_view name = node.name();
  return name.substr(name.find(':') + 1);
}

/// An element that can say where it stands.
struct Element {
  pugi::xml_node node;
  const Source& source;

  [[nodiscard]] std::string_view text() const { return node.child_value(); }
  [[nodiscard]] std::string place() const { return source.place(node.offset_debug()); }

  /// The first one of that name, or one without a node.
  [[nodiscard]] Element child(std::string_view name) const {
    const auto named = [name](const pugi::xml_node& n) { return local_name(n) == name; };
    return {node.find_child(named), source};
  }
  [[nodiscard]] Element required(std::string_view name) const {
    const Element found = child(name);
    if (!found.node) {
      fail("{}: a {} without {}; download the file again", place(), local_name(node), name);
    }
    return found;
  }
  [[nodiscard]] std::vector<Element> children(std::string_view name) const {
    std::vector<Element> found;
    for (const pugi::xml_node& n : node) {
      if (local_name(n) == name) found.push_back({n, source});
    }
    return found;
  }
};

std::int64_t time_of(const Element& element) {
  std::int64_t utc_s = 0;
  if (!parse_utc(element.text(), utc_s) || utc_s % kSecondsPerQuarterHour != 0) {
    fail("{}: \"{}\" is not the UTC start of a quarter-hour; download the file again",
         element.place(), one_line(element.text(), 40));
  }
  return utc_s;
}

template <typename Number>
Number number_of(const Element& element) {
  const std::string_view text = element.text();
  Number value{};
  const auto [end, error] = std::from_chars(text.begin(), text.end(), value);
  if (error != std::errc{} || end != text.end() || !std::isfinite(static_cast<double>(value))) {
    fail("{}: \"{}\" is not a number; download the file again", element.place(),
         one_line(text, 40));
  }
  return value;
}

/// Which party a point's price is for; documents of some areas name none.
enum Category { kBoth, kLong, kShort, kCategoryCount };

struct Point {
  std::int64_t position = 0;  ///< 1 = first of its period
  double eur_per_mwh = kNotPublished;
  Category category = kBoth;
};

struct Period {
  std::int64_t start_utc_s = 0;
  std::int64_t resolution_s = 0;
  std::int64_t positions = 0;
  std::vector<Point> points{};  ///< in order of position
};

std::int64_t resolution_s_of(const Element& element) {
  const std::string_view text = element.text();
  if (text == "PT15M") return 900;
  if (text == "PT30M") return 1800;
  if (text == "PT60M" || text == "PT1H") return 3600;
  fail("{}: resolution \"{}\" is not known; PT15M, PT30M and PT60M are", element.place(),
       one_line(text, 20));
}

Point point_of(const Element& element, std::int64_t positions) {
  Point point{.position = number_of<std::int64_t>(element.required("position"))};
  if (point.position < 1 || point.position > positions) {
    fail("{}: position {} is outside its period (they start at 1, end at {}); download it again",
         element.place(), point.position, positions);
  }
  const Element amount = element.child("imbalance_Price.amount");
  if (amount.node) point.eur_per_mwh = number_of<double>(amount);
  const std::string_view category = element.child("imbalance_Price.category").text();
  point.category = category == "A04" ? kLong : category == "A05" ? kShort : kBoth;
  return point;
}

Period period_of(const Element& element) {
  const Element interval = element.required("timeInterval");
  Period period{.start_utc_s = time_of(interval.required("start")),
                .resolution_s = resolution_s_of(element.required("resolution"))};
  const std::int64_t span_s = time_of(interval.required("end")) - period.start_utc_s;
  if (span_s <= 0 || span_s > kPeriodSecondsMax) {
    fail("{}: a period may last up to a year, not {} s; download the file again", interval.place(),
         span_s);
  }
  period.positions = span_s / period.resolution_s;
  for (const Element& point : element.children("Point")) {
    period.points.push_back(point_of(point, period.positions));
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
  /// The one price; NaN when there are two different ones.
  [[nodiscard]] double single() const {
    if (!is_published(long_eur_per_mwh)) return short_eur_per_mwh;
    if (!is_published(short_eur_per_mwh)) return long_eur_per_mwh;
    return long_eur_per_mwh == short_eur_per_mwh ? long_eur_per_mwh : kNotPublished;
  }
};
using QuarterHourPrices = std::map<std::int64_t, Prices>;  ///< by start, UTC seconds

/// A price of a longer interval is that of each of its quarter-hours; where points repeat, one holds
/// until the next of its own category.
void add_period(const Period& period, bool repeats, QuarterHourPrices& prices) {
  std::array<std::optional<Point>, kCategoryCount> current;
  auto next = period.points.begin();
  for (std::int64_t position = 1; position <= period.positions; ++position) {
    if (!repeats) current = {};
    for (; next != period.points.end() && next->position == position; ++next) {
      current[next->category] = *next;
    }
    const std::int64_t end_utc_s = period.start_utc_s + position * period.resolution_s;
    for (const std::optional<Point>& point : current) {
      if (!point) continue;
      for (std::int64_t utc_s = end_utc_s - period.resolution_s; utc_s < end_utc_s;
           utc_s += kSecondsPerQuarterHour) {
        prices[utc_s].set(*point);
      }
    }
  }
}

/// Everything here reckons in EUR/MWh.
void require_unit(const Element& unit, std::string_view wanted) {
  if (!unit.node || unit.text() == wanted) return;
  fail("{}: prices in or per \"{}\" where {} is needed; use an area that publishes EUR per MWH",
       unit.place(), one_line(unit.text(), 20), wanted);
}

void add_series(const Element& series, QuarterHourPrices& prices) {
  require_unit(series.child("currency_Unit.name"), "EUR");
  require_unit(series.child("price_Measure_Unit.name"), "MWH");
  const bool repeats = series.child("curveType").text() == "A03";
  for (const Element& period : series.children("Period")) {
    add_period(period_of(period), repeats, prices);
  }
}

/// ENTSO-E may answer with a document that holds only the reason why there are no prices.
void require_balancing_document(const pugi::xml_node& root, std::string_view name) {
  if (local_name(root) == "Acknowledgement_MarketDocument") {
    std::string reason;
    for (const pugi::xpath_node& text : root.select_nodes(".//*[local-name()='text']")) {
      reason += std::string(text.node().child_value()) + " ";
    }
    fail("{}: ENTSO-E sent no prices but a reason: \"{}\"", name, one_line(reason, 200));
  }
  if (local_name(root) != "Balancing_MarketDocument") {
    fail("{}: not an ENTSO-E balancing document (A85) but \"{}\"", name,
         one_line(local_name(root), 60));
  }
}

QuarterHourPrices prices_of(const Source& source) {
  pugi::xml_document document;
  // UTF-8 whatever the declaration says: a converted text would have other offsets.
  const pugi::xml_parse_result parsed = document.load_buffer(
      source.text.data(), source.text.size(), pugi::parse_default, pugi::encoding_utf8);
  // What a broken document began as tells more than where it breaks.
  for (const pugi::xml_node& root : document) require_balancing_document(root, source.name);
  if (!parsed) {
    fail("{}: cut short or damaged ({}); download it again", source.place(parsed.offset),
         parsed.description());
  }
  QuarterHourPrices prices;
  for (const pugi::xml_node& root : document) {
    for (const Element& series : Element{root, source}.children("TimeSeries")) {
      add_series(series, prices);
    }
  }
  if (prices.empty()) fail("{}: holds no imbalance prices; choose other days", source.name);
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
  for (const auto& [utc_s, prices] : prices_of({text, name})) {
    QuarterHour quarter_hour;
    quarter_hour.utc_s = utc_s;
    quarter_hour.price_eur_per_mwh = prices.single();
    if (!is_published(quarter_hour.price_eur_per_mwh)) {
      rows.dual_priced_quarter_hours.insert(utc_s);
    }
    rows.quarter_hours.push_back(quarter_hour);
  }
  return rows;
}

}  // namespace bess
