// How the controller is, as anybody may ask: what `bess-edge status --json` says, and the troubles
// in it. It is asked without locks, so that nobody who asks can be in a controller's way.
#pragma once

#include <string>
#include <vector>

#include "edge/notify/alarm_book.h"
#include "shared/host/json.h"

namespace bess {

struct ControllerStatus {
  std::string trouble{};  ///< empty when there is a status; else why there is none
  Json json = Json::object();
};

/// Runs `program`; waits ten seconds at most.
ControllerStatus ask_controller(const std::string& program, const std::string& config_path);

/// Each reason that health names, as it is named: rules of a later controller are told as well.
std::vector<Trouble> troubles_of(const ControllerStatus& status);

}  // namespace bess
