// Scenario in scaled wall time: the real bess-edge with bess-sim battery and bess-sim market, over
// Modbus TCP or a pair of pseudo terminals, and over HTTP. Events kill, stop and continue
// processes. Alternatively the real bess-edge with a real battery.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/real/real_options.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

/// Begin of the error message of a run on a late machine.
inline constexpr std::string_view kTooLate = "not judged: this machine was late";

/// Paths of the programs, and the real battery if any.
struct WallSite {
  std::string edge;
  std::string simulators;
  std::optional<RealBattery> battery{};  ///< empty: simulated
};

/// The run cannot be judged: the wake-up latency is too large for its time scale.
class HostTooSlow : public UserError {
 public:
  using UserError::UserError;
};

/// Throws HostTooSlow; UserError if a program fails or a real battery exceeds its limits;
/// Interrupted on a stop request. A real battery is released in all cases.
Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
                  const WorkFolder& folder);

/// Reason why this machine cannot run it; empty: it can.
std::string why_not_wall(const Scenario& scenario);

}  // namespace bess
