// Elements common to ENTSO-E's documents, with their place in the file. Include only in readers of
// those documents: it includes pugixml.
#pragma once

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/plain_text.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "shared/units_and_limits.h"
#include "shared/utc_text.h"
#include "workstation/data/market/series/local_date.h"

namespace bess {

inline constexpr std::int64_t kEntsoePeriodSecondsMax =
    366LL * kSecondsPerDay;  ///< the platform returns at most one year

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
  const std::string_view text = element.text();
  Number value{};
  const auto [end, error] = std::from_chars(text.begin(), text.end(), value);
  if (error != std::errc{} || end != text.end() || !std::isfinite(static_cast<double>(value))) {
    fail("{}: \"{}\" is not a number; download the file again", element.place(),
         one_line(text, 40));
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

/// All prices are in EUR/MWh.
inline void require_entsoe_unit(const EntsoeElement& unit, std::string_view wanted) {
  if (!unit.node || unit.text() == wanted) return;
  fail("{}: prices in or per \"{}\" where {} is needed; use an area that publishes EUR per MWH",
       unit.place(), one_line(unit.text(), 20), wanted);
}

}  // namespace bess
