// [page] of the controller's configuration, and where the controller's log lies. Read apart from
// the controller's own reader, as [notify] is: a configuration that keeps the controller from
// starting must still be seen.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/page/access_tokens.h"

namespace bess {

struct PageSettings {
  std::string config_path;
  std::string program;             ///< bess-edge, which answers
  std::string ring;                ///< the decision log
  std::string run_ring;            ///< what of it is in memory; empty = none
  std::string name;                ///< in the title
  std::string host = "127.0.0.1";  ///< numeric; where it listens
  std::int32_t port = 8745;
  std::vector<std::string>
      hosts;                   ///< names under which it may be asked for, besides its own address
  std::int32_t refresh_s = 5;  ///< what is shown is at most this old
  AccessTokens tokens;         ///< who may order; none = nobody
};

/// False with one line: file, key, and the mend. Makes nothing and connects to nothing.
bool load_page_settings(const std::string& path, PageSettings& settings, std::string& error);

}  // namespace bess
