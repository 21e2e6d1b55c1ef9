// [page] of the controller's configuration, and where the controller's log lies.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/companions/common/controller_places.h"

namespace bess {

struct PageSettings : ControllerPlaces {
  std::string host = "127.0.0.1";  ///< numeric; where it listens
  std::int32_t port = 8745;
  std::vector<std::string>
      hosts;                   ///< names under which it may be asked for, besides its own address
  std::int32_t refresh_s = 5;  ///< what is shown is at most this old
};

/// False with one line: file, key, and the mend. Makes nothing and connects to nothing.
bool load_page_settings(const std::string& path, PageSettings& settings, std::string& error);

}  // namespace bess
