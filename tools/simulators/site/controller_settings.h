// Configuration of bess-edge for a simulated battery and market, and their scaled clock: for
// demonstrations, scenarios and tests of processes.
#pragma once

#include <fmt/core.h>

#include <optional>
#include <string>

#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {

/// Lines of TOML by table, each with its line end.
struct ControllerSettings {
  bool control = true;
  std::string battery{};  ///< map and address
  std::string market = "http://127.0.0.1:8080";
  std::string price{};  ///< keys other than the URL
  std::string guard{};
  std::string state = "folder = \"state\"\n";
  std::string tables{};  ///< complete tables
  std::string csv = "edge.csv";
  std::optional<ScaledClock> clock{};  ///< of all programs of the testbed
};

/// URL of a dataset of bess-sim market, such as "http://127.0.0.1:8080" and "ods161".
inline std::string records_url(const std::string& market, const std::string& dataset) {
  return fmt::format(
      "{}/api/explore/v2.1/catalog/datasets/{}/records?order_by=datetime%20desc&limit=20", market,
      dataset);
}

inline std::string controller_settings(const ControllerSettings& s) {
  std::string text = fmt::format("control = {}\n[battery]\n{}", s.control, s.battery);
  text += fmt::format("[price]\nurl = \"{}\"\n{}", records_url(s.market, "ods161"), s.price);
  text += fmt::format("[guard]\n{}[state]\n{}{}", s.guard, s.state, s.tables);
  text += fmt::format("[log]\ncsv = \"{}\"\n", s.csv);
  if (!s.clock) return text;
  return text + fmt::format(
                    "[simulation]\ntime_scale = {}\nutc_start = \"{}\"\nanchor_monotonic_ns = {}\n",
                    s.clock->scale, utc_text(s.clock->anchor_utc_s).view(),
                    s.clock->anchor_monotonic_ns);
}

}  // namespace bess
