// Status of the controller as bess-edge prints it, and the alerts in it. Takes no lock, so it
// cannot delay the controller.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/companions/common/controller_places.h"
#include "edge/companions/notify/notifier_state.h"
#include "edge/records/log/alerts.h"
#include "shared/host/json.h"

namespace bess {

struct ControllerStatus {
  std::string trouble{};  ///< why there is no status, or empty
  Json json = Json::object();
};

/// Runs `bess-edge status --json`; waits at most 10 s.
ControllerStatus ask_controller(const ControllerPlaces& controller);

/// Runs `bess-edge earned --json` for one day; waits at most 30 s. Does not exist without an answer
/// or without records of that day.
Json ask_earned(const ControllerPlaces& controller, std::vector<std::string> words);

/// `found`: as of `alert_line`.
SeenAlert seen_alert(Alert alert, const std::string& found = "");

/// Each alert of `status --json` unchanged, so that alerts of a later version are reported too.
std::vector<SeenAlert> seen_alerts(const ControllerStatus& status);

/// Why the settled prices in `file` are late; empty if they are not.
std::string settled_trouble(const std::string& file, std::int64_t now_utc_s);

}  // namespace bess
