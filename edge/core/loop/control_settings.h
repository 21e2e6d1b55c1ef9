// What the operator decides about the control loop; filled by edge_config before the loop starts.
#pragma once

#include <cstdint>

#include "edge/core/control/frozen_price.h"
#include "edge/core/control/reserve.h"
#include "edge/core/control/safety_guard.h"
#include "edge/core/supervision/supervision.h"

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
  SupervisionSettings supervision{};
  FrozenPriceSettings frozen_price{};
  // What a price source that lies can do to the battery in a day and in an hour. Measured on 22
  // November 2026 on the yardstick (142 days of 2023, the shipped student at C/2): at most 5.73
  // cycles a day and 17 reversals in any hour, 13 in 99.9 % of them.
  std::int32_t cycles_per_day_max_e4 = 60'000;  ///< at C/2, in 1e-4 full cycles; 0 = no budget
  std::int32_t reversals_per_hour_max = 20;     ///< between charging and discharging; 0 = any
  ReservePlan reserve{};
  std::int32_t full_charge_every_days = 0;  ///< 0 = never; its power is the guard's
};

}  // namespace bess
