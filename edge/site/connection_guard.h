// Limits of the connection to the grid, for the battery behind the house's meter: pure integers,
// from what was measured to how far the battery's order may go.
//
//   house = grid - battery, both measured         grid with an order = house + order
//   charge    <= import_w_max - margin - house     discharge <= export_w_max - margin + house
//
// The house is never limited: where its load alone is above a limit, the battery is left 0 W.
//
// Quarter-hour peak (the Belgian capacity tariff bills the mean import of the dearest
// quarter-hour): with E imported so far, B of it taken by the battery, s seconds left and C =
// peak_w_max - margin,
//   E + (house + charge) s <= 900 C      the mean stays under the cap if the house stays
// If the house does rise, so that E + house s > 900 C, the battery gives back what it took in this
// quarter-hour (relief). Thus a quarter-hour ends above the cap only where the house alone leads
// there; what the margin must cover is a rise that comes too late to be answered, and what an empty
// battery has lost of the energy that it gives back. With `peak_shave` relief is not bounded by B:
// the house itself is kept under.
#pragma once

#include <cstdint>

#include "edge/control/quarter_hour_energy.h"
#include "edge/control/site_range.h"

namespace bess {

struct ConnectionSettings {
  std::int32_t import_w_max = kAnyPowerW;
  std::int32_t export_w_max = kAnyPowerW;
  std::int32_t peak_w_max = kAnyPowerW;  ///< mean of a quarter-hour
  std::int32_t margin_w = 200;           ///< kept free below each of the three
  bool peak_shave = false;
};

struct ConnectionState {
  std::int32_t grid_w = 0;
  std::int32_t battery_w = 0;
  std::int32_t relief_w_max = 0;  ///< P: what the battery can discharge
  QuarterHourEnergy::Sums quarter_hour{};
};

/// Narrows `range` to what the connection bears with `margin_w` kept free.
void limit_at_connection(const ConnectionSettings& settings, std::int32_t margin_w,
                         const ConnectionState& state, SiteRange& range);

}  // namespace bess
