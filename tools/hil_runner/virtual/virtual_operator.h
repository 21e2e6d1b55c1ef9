// Whoever speaks to the controller in a virtual run: an operator's hold, the limits of another
// program, and that a trip was cleared. What they say outlives the edge, as their files do; it is
// formed and read by the edge's own code.
#pragma once

#include <cstdint>
#include <string>

#include "edge/control/hold.h"
#include "edge/site/connection_guard.h"
#include "edge/storage/recall.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

class VirtualOperator {
 public:
  /// `now_utc_s` by the edge's clock; `trip` is the one in force, if any.
  void act(const ScenarioEvent& event, std::int64_t now_utc_s, const Trip& trip);

  [[nodiscard]] const HoldMailbox& holds() const { return holds_; }
  [[nodiscard]] bool is_cleared(std::int64_t trip_utc_s) const { return cleared_.has(trip_utc_s); }
  /// As the edge's limit file has it.
  Status read(OutsideLimit& limit, bool& is_set) const;

 private:
  HoldMailbox holds_;
  ClearedTrips cleared_;
  std::string limit_;  ///< the file's text; empty: there is no file
};

}  // namespace bess
