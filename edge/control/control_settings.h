// What the operator decides about the control loop; filled by edge_config before the loop starts.
#pragma once

#include <cstdint>

#include "edge/control/reserve.h"
#include "edge/control/safety_guard.h"

namespace bess {

struct ControlSettings {
  bool control = false;  ///< false: everything but writing
  GuardSettings guard;
  std::int32_t order_duration_s = 300;  ///< until the device's watchdog ends it
  bool has_watchdog = false;            ///< the device ends an order that is not renewed
  std::int32_t hold_s = 300;            ///< 0 W held after a stop reason before releasing
  std::int32_t price_wait_s = 20;
  std::int32_t read_lead_s = 3;
  std::int32_t order_deadline_s = 60;  ///< an order in force later than this after its tick is late
  std::int32_t cycles_per_day_max_e4 = 0;  ///< in 1e-4 full cycles; 0 = no budget
  ReservePlan reserve{};
  std::int32_t full_charge_every_days = 0;  ///< 0 = never; its power is the guard's
  /// After the tick nothing is ordered before this has passed: many controllers on one grid must not
  /// switch at one instant.
  std::int32_t start_offset_ms = 0;
};

}  // namespace bess
