// Point policies: edge/device/maps/points.md lists the treatment of missing and out-of-range values
// of every point. Compared with the maps here; BESS_UPDATE_GOLDEN updates it.
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

TEST(PointPolicies, AreInTheTable) {
  std::ostringstream table;
  table << "# Points of the register maps\n\n"
           "Treatment of values that cannot be read or are out of range. *required*: no "
           "measurement without it;\n*protective*: the battery is stopped without it; *read*: "
           "reported or compared; the rest is written,\nor checked for identity. *optional*: "
           "required once the device has shown it.\n";
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
            << (p.unknown_is_max ? "read as the maximum" : "no value") << " |\n";
    }
  }
  expect_golden(BESS_SOURCE_DIR "/edge/device/maps/points.md", table.str());
}

}  // namespace
}  // namespace bess
