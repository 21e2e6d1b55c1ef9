// [state], [log] and [metrics]: what the controller keeps, and where; and the paths below.
#pragma once

#include <string_view>

#include "edge/log/event_log.h"
#include "shared/fixed_text.h"
#include "shared/host/toml_reader.h"

namespace bess {

/// Where the controller keeps what outlives it.
struct StateSettings {
  FixedText<511> folder;
  FixedText<511> run_folder;  ///< on a memory file system, beside `folder`; empty = none
};

/// The log lies in the [state] folders, unless it is said otherwise.
struct KeptFiles {
  StateSettings& state;
  EventLogSettings& log;
};
void read_state(TomlTable table, KeptFiles kept);
void read_log(TomlTable table, EventLogSettings& log);
void read_metrics(TomlTable table, EventLogSettings& log);

}  // namespace bess
