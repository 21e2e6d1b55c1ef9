// Controller location for companion programs: program, folders, name. Independent of the
// controller's own reader, so that a configuration that stops the controller is still reported.
#pragma once

#include <string>

#include "shared/host/toml_reader.h"

namespace bess {

struct ControllerPlaces {
  std::string name;  ///< [battery] name
  std::string id;    ///< battery_id
  std::string config_path;
  std::string program;       ///< path of bess-edge
  std::string state_folder;  ///< [state] folder
};

/// `root`: whole configuration. `program` is bess-edge in the folder of this program.
ControllerPlaces controller_places(TomlTable& root);

}  // namespace bess
