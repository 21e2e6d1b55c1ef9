// A scenario in wall time, scaled: the real bess-edge between the real bess-sim battery and
// bess-sim market, over Modbus TCP or a pair of pseudo terminals, and over HTTP. Processes are
// killed, stopped and continued as the scenario says. Or the real bess-edge and a battery that is
// there already.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/real/real_battery.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// How the error of a run begins for which this machine was too late.
inline constexpr std::string_view kTooLate = "not judged: this machine was late";

/// What a run stands on: the programs that are started, and the battery if there is one already.
struct WallSite {
  std::string edge;
  std::string simulators;
  std::optional<RealBattery> battery{};  ///< nothing: a simulated one is started
};

/// What was run cannot be judged: the machine woke whoever slept too late for the scenario's pace.
class MachineTooLate : public UserError {
 public:
  using UserError::UserError;
};

/// Throws MachineTooLate; UserError when a program cannot be started or says why it does not run,
/// or a real battery's limits are broken; Interrupted when a stop was requested. A real battery is
/// released, however it ends.
Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
                  const WorkFolder& folder);

/// What only another machine can do, in words; empty: it can run here.
std::string why_not_wall(const Scenario& scenario);

}  // namespace bess
