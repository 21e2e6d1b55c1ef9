// The configuration with which bess-edge drives a site's battery on the prices of its market: the
// one text of it, for demonstrations, scenarios and tests of processes.
#pragma once

#include <optional>
#include <string>

#include "tools/site/site_clock.h"

namespace bess {

/// Lines of TOML, by their table; each whole, with its end.
struct ControllerSettings {
  bool control = true;
  std::string battery{};  ///< map, and where it is
  std::string market = "http://127.0.0.1:8080";
  std::string price{};  ///< beside the URL
  std::string guard{};
  std::string state = "folder = \"state\"\n";
  std::string tables{};  ///< whole ones
  std::string csv = "edge.csv";
  std::optional<SiteClock> clock{};
};

std::string controller_settings(const ControllerSettings& settings);

/// Of a market as bess-sim market plays it, without its end: "http://127.0.0.1:8080", "ods161".
std::string records_url(const std::string& market, const std::string& dataset);

}  // namespace bess
