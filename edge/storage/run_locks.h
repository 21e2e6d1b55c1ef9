// What a controller must have for itself before it does anything: its battery and its state folder.
#pragma once

#include "edge/settings/edge_config.h"
#include "edge/storage/instance_lock.h"

namespace bess {

/// Lock of the battery: the same name for every configuration that leads to it.
FixedText<639> battery_lock_path(const EdgeConfig& config);
/// Of [battery] name: two controllers of one machine must not report under the same.
FixedText<639> name_lock_path(const EdgeConfig& config);
/// Where every controller of this machine locks its battery; no configuration leads past it.
std::string_view lock_folder();
/// Process of the controller of this configuration, as `holder_of` has it: by the lock of its state
/// folder or, where that could not be made there, of its run folder.
int controller_holding(const EdgeConfig& config);
bool is_controller_running(const EdgeConfig& config);

struct RunLocks {
  InstanceLock battery;
  InstanceLock name;
  InstanceLock state;
  InstanceLock run;  ///< where there is a run folder
};

/// --check needs the battery alone. False with one line.
bool lock_battery(const EdgeConfig& config, RunLocks& locks, FileMessage& error);
/// Makes state and run folder if they are missing; refuses files of another user in them. A run
/// folder that cannot be made is told and no reason to fail.
bool lock_state(const EdgeConfig& config, RunLocks& locks, FileMessage& error);

}  // namespace bess
