// edge/device/maps/points.md: of every point of every map, what becomes of a value that is missing
// or beyond its range. Held against the maps here; BESS_UPDATE_GOLDEN renews it.
#include <gtest/gtest.h>

#include <algorithm>
#include <sstream>

#include "tests/support/golden_file.h"
#include "tests/support/shipped_maps.h"

namespace bess {
namespace {

bool contains(const auto& points, int point) {
  return std::find(points.begin(), points.end(), point) != points.end();
}

std::string role_of(const RegisterMap& map, int point) {
  if (contains(map.required, point)) return "required";
  if (contains(map.protective, point)) return "protective";
  if (contains(map.measure, point)) return "read";
  return "written or checked";
}

std::string beyond(const RegisterPoint& p) {
  if (p.slack == 0) return "rejected";
  return p.slack >= p.value_max - p.value_min ? "cut" : "cut within " + std::to_string(p.slack);
}

TEST(PointPolicies, StandInTheTable) {
  std::ostringstream table;
  table << "# Points of the register maps\n\n"
           "What becomes of a value that cannot be read, or lies beyond its range. *required*: "
           "nothing is\nmeasured without it; *protective*: the battery is stopped without it; "
           "*read*: told or compared; the\nrest is written, or looked at for identity. *optional*: "
           "required as soon as the device has shown it.\n";
  for (const MapVariant& variant : kShippedMapVariants) {
    const RegisterMap map = load_shipped_map(variant);
    table << "\n## " << variant.map << (*variant.variant == '\0' ? "" : " ") << variant.variant
          << "\n| point | register | range | role | beyond the range | not implemented |\n"
             "|---|---|---|---|---|---|\n";
    for (int i = 0; i < map.points.size(); ++i) {
      const RegisterPoint& p = map.points[i];
      table << "| " << p.name.view() << " | ";
      if (p.model >= 0) table << "model " << map.models[p.model] << " + ";
      table << p.address << " | " << p.value_min << " to " << p.value_max << " | "
            << role_of(map, i) << (p.optional ? ", optional" : "") << " | " << beyond(p) << " | "
            << (p.unknown_is_max ? "taken for the largest" : "no value") << " |\n";
    }
  }
  expect_golden(BESS_SOURCE_DIR "/edge/device/maps/points.md", table.str());
}

}  // namespace
}  // namespace bess
