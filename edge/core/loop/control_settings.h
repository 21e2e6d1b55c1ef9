// Control loop settings, filled by edge_config before the loop starts.
#pragma once

#include <cstdint>

#include "edge/core/control/frozen_price.h"
#include "edge/core/control/reserve.h"
#include "edge/core/control/safety_guard.h"
#include "edge/core/supervision/supervision.h"

namespace bess {

struct ControlSettings {
  bool control = false;  ///< false: everything except writing
  GuardSettings guard;
  std::int32_t order_duration_s = 300;  ///< until the device's watchdog ends it
  bool has_watchdog = false;            ///< the device ends an order that is not refreshed
  std::int32_t hold_s = 300;            ///< duration of 0 W after a stop reason, before the release
  std::int32_t price_wait_s = 20;
  std::int32_t read_lead_s = 3;
  std::int32_t order_deadline_s = 60;  ///< after its tick; an order in force later is late
  SupervisionSettings supervision{};
  FrozenPriceSettings frozen_price{};
  // Bounds on the damage of a wrong price source per day and per hour. Measured on 22 November 2026
  // on the benchmark (142 days of 2023, the shipped student at C/2): at most 5.73 full cycles a day
  // and 17 reversals in any hour, 13 in 99.9 % of them.
  std::int32_t cycles_per_day_max_e4 = 60'000;  ///< at C/2, in 1e-4 full cycles; 0 = no budget
  std::int32_t reversals_per_hour_max = 20;     ///< between charging and discharging; 0 = no limit
  ReservePlan reserve{};
  std::int32_t full_charge_every_days = 0;  ///< 0 = never; the guard has its power
};

}  // namespace bess
