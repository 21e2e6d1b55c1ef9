// Elements common to ENTSO-E's documents, with their place in the file. Include only in readers of
// those documents: it includes pugixml.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"

namespace bess {

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
inline std::string_view xml_local_name(const pugi::xml_node& node) {
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

inline std::int64_t entsoe_time_of(const EntsoeElement& element) {
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

inline std::int64_t entsoe_resolution_s_of(const EntsoeElement& element) {
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

inline EntsoePeriod entsoe_period_of(const EntsoeElement& element) {
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
inline std::int64_t entsoe_position_of(const EntsoeElement& point, const EntsoePeriod& period) {
  const auto position = entsoe_number_of<std::int64_t>(point.required("position"));
  if (position < 1 || position > period.positions) {
    fail("{}: position {} is outside its period (they start at 1, end at {}); download it again",
         point.place(), position, period.positions);
  }
  return position;
}

/// Reads a document whose roots are of `kind` (`what` in words). Throws UserError otherwise, also
/// for ENTSO-E's answer without prices.
inline void load_entsoe_document(pugi::xml_document& document, const EntsoeSource& source,
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
inline void require_entsoe_units(const EntsoeElement& series) {
  for (const auto& [name, wanted] :
       {std::pair{"currency_Unit.name", "EUR"}, std::pair{"price_Measure_Unit.name", "MWH"}}) {
    const EntsoeElement unit = series.child(name);
    if (!unit.node || unit.text() == wanted) continue;
    fail("{}: prices in or per \"{}\" where {} is needed; use an area that publishes EUR per MWH",
         unit.place(), one_line(unit.text(), 20), wanted);
  }
}

/// Refuses a second zone; empty ones are unknown.
inline void set_entsoe_zone(const EntsoeElement& element, std::string_view named,
                            std::string& zone) {
  if (!zone.empty() && !named.empty() && named != zone) {
    fail("{}: prices of the zone {} after those of {}; import one zone at a time", element.place(),
         one_line(named, 20), one_line(zone, 20));
  }
  if (!named.empty()) zone = named;
}

}  // namespace bess
