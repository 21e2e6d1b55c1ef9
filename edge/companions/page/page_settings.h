// Settings of the page: [page] of the controller's configuration, and the controller's paths.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/companions/common/controller_places.h"

namespace bess {

struct PageSettings : ControllerPlaces {
  std::string host = "127.0.0.1";  ///< numeric address to listen on
  std::int32_t port = 8745;
  std::vector<std::string> hosts;  ///< accepted host names, in addition to its address
  std::int32_t refresh_s = 5;      ///< maximum age of the data
};

/// False with one line: file, key and remedy. Creates nothing and opens no connection.
bool load_page_settings(const std::string& path, PageSettings& settings, std::string& error);

}  // namespace bess
