// A scenario in wall time, scaled: the real bess-edge between the real bess-sim battery and bess-sim market,
// over Modbus TCP or a pair of pseudo terminals, and over HTTP. Processes are killed, stopped and
// continued as the scenario says.
#pragma once

#include <string>

#include "shared/host/minute_file.h"
#include "tools/hil_runner/evidence.h"
#include "tools/hil_runner/scenario.h"
#include "tools/hil_runner/work_folder.h"

namespace bess {

/// The programs that are started.
struct WallPrograms {
  std::string edge;
  std::string simulators;
};

/// Throws UserError when a program cannot be started or says why it does not run.
Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices,
                  const WallPrograms& programs, const WorkFolder& folder);

/// What only another machine can do, in words; empty: it can run here.
std::string why_not_wall(const Scenario& scenario);

}  // namespace bess
