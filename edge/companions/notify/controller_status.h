// The controller's status as bess-edge prints it, and the troubles in it. Asking takes no lock, so
// it cannot delay the controller.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/companions/common/controller_places.h"
#include "edge/companions/notify/notifier_state.h"
#include "shared/host/json.h"

namespace bess {

struct ControllerStatus {
  std::string trouble{};  ///< empty when there is a status; else why there is none
  Json json = Json::object();
};

/// `bess-edge status --json`; waits ten seconds at most.
ControllerStatus ask_controller(const ControllerPlaces& controller);

/// `bess-edge earned --json` of one day; waits half a minute at most. Does not exist where the log
/// has nothing of that day, or there is no answer.
Json ask_earned(const ControllerPlaces& controller, std::vector<std::string> words);

/// Each reason that health names, as it is named: rules of a later controller are reported as well.
std::vector<Trouble> troubles_of(const ControllerStatus& status);

/// Why the settled prices in `file`, which should be there days ago, are not; empty: they are.
std::string settled_trouble(const std::string& file, std::int64_t now_utc_s);

}  // namespace bess
