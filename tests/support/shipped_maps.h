// Register maps of edge/device/maps by name, and all of their variants.
#pragma once

#include <gtest/gtest.h>

#include <ostream>
#include <string>

#include "edge/device/registers/map_file.h"

namespace bess {

struct MapVariant {
  const char* map;
  const char* variant;  ///< empty: the map has none, or its first
  friend void PrintTo(const MapVariant& v, std::ostream* out) { *out << v.map << " " << v.variant; }
};

inline constexpr MapVariant kShippedMapVariants[] = {{"alphaess", "block"},
                                                     {"alphaess", "five_writes"},
                                                     {"alphaess", "ten_and_one"},
                                                     {"simulator", ""},
                                                     {"sunspec_124", ""},
                                                     {"sunspec_704", ""},
                                                     {"fronius_gen24", ""},
                                                     {"victron_ess3", "single_phase"},
                                                     {"victron_ess3", "three_phase"},
                                                     {"sungrow_sh", "external_ems"},
                                                     {"sungrow_sh", "forced"},
                                                     {"huawei_luna2000", ""},
                                                     {"sma", "bms_mode"},
                                                     {"sma", "setpoint"},
                                                     {"solaredge", ""},
                                                     {"goodwe_et", "registers_47511"},
                                                     {"goodwe_et", "registers_42000"},
                                                     {"kostal_plenticore", ""},
                                                     {"marstek_venus", "gen_3"},
                                                     {"marstek_venus", "gen_1_2"}};

inline std::string shipped_map(const std::string& name) {
  return std::string(BESS_SOURCE_DIR) + "/edge/device/maps/" + name + ".toml";
}

inline RegisterMap load_good_map(const std::string& path, const std::string& variant = "") {
  RegisterMap map;
  std::string error;
  EXPECT_TRUE(load_register_map(path, variant, map, error)) << error;
  return map;
}

inline RegisterMap load_shipped_map(const MapVariant& wanted) {
  return load_good_map(shipped_map(wanted.map), wanted.variant);
}

}  // namespace bess
