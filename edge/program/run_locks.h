// What a controller must have for itself before it does anything: its battery and its state folder.
#pragma once

#include "edge/program/edge_config.h"
#include "edge/program/instance_lock.h"

namespace bess {

/// Lock of the battery in a folder: the same name for every configuration that leads to it.
FixedText<639> battery_lock_path(const EdgeConfig& config, std::string_view folder);
/// Where every controller of this machine locks its battery; no configuration leads past it.
std::string_view standard_lock_folder();
/// Lock of the state folder; held by the controller that writes the status there.
FixedText<639> state_lock_path(const EdgeConfig& config);
/// Whether a controller of this configuration holds that lock.
bool is_controller_running(const EdgeConfig& config);

struct RunLocks {
  InstanceLock battery;
  InstanceLock battery_elsewhere;  ///< in [state] lock_folder as well, if it names one
  InstanceLock state;
};

/// --check needs the battery alone. False with one line.
bool lock_battery(const EdgeConfig& config, RunLocks& locks, FileMessage& error);
/// Makes the state folder if it is missing; refuses files of another user in it.
bool lock_state(const EdgeConfig& config, RunLocks& locks, FileMessage& error);

}  // namespace bess
