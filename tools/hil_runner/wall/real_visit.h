// A real battery in a run: its sign is checked first, it is looked at every second, and however the
// run ends it is given back.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tools/hil_runner/base/stop_request.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/real/real_battery.h"
#include "tools/hil_runner/wall/edge_process.h"

namespace bess {

class RealVisit {
 public:
  /// All must outlive this object.
  RealVisit(const Scenario& scenario, const RealBattery& battery, const WorkFolder& folder,
            EdgeProcess& edge)
      : scenario_(scenario), battery_(battery), folder_(folder), edge_(edge) {}

  /// The edge's own check of the sign: half a minute of a small order.
  void commission();
  /// Throws Interrupted when somebody asked for the end, UserError beyond the limits.
  void look();
  /// Of its bus, of the edge that is started next.
  [[nodiscard]] std::string next_recording();
  [[nodiscard]] bool has_begun() const { return edge_.is_started() || !recordings_.empty(); }
  /// Stops the edge, which releases the battery; where it did not, says so and tries it once more.
  void give_back();
  /// What went over its bus, and what it measured.
  void tell(Evidence& evidence) const;

 private:
  void heed_stop() const;
  void show(const CycleRecord& cycle) const;

  const Scenario& scenario_;
  const RealBattery& battery_;
  const WorkFolder& folder_;
  EdgeProcess& edge_;
  AbortKey key_;
  std::vector<std::string> recordings_;
  std::int64_t next_look_ns_ = 0;
};

}  // namespace bess
