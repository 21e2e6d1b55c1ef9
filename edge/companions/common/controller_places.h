// What a companion program knows of the controller by its configuration: which program answers, and
// where its state lies. Read apart from the controller's own reader: a configuration that keeps the
// controller from starting must still be seen, and reported.
#pragma once

#include <string>

#include "shared/host/toml_reader.h"

namespace bess {

struct ControllerPlaces {
  std::string name;  ///< [battery] name
  std::string id;    ///< battery_id
  std::string config_path;
  std::string program;       ///< bess-edge, which answers
  std::string state_folder;  ///< [state] folder
};

/// Of the whole configuration. `program` is bess-edge beside this program, as both are installed.
ControllerPlaces controller_places(TomlTable& root);

}  // namespace bess
