// How long after each tick this controller orders, and how long after 12:50 it asks for tomorrow's
// prices, so that a thousand of them do not do it at one instant.
#pragma once

#include <cstdint>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

/// Between 0 and `spread_s`, the same at every start. From a checksum of the machine and of the
/// battery's place: most sites have their battery at the same address, and one machine may drive
/// two.
std::int32_t start_offset_ms(std::int32_t spread_s, std::string_view machine_id,
                             std::string_view battery_place);

/// Contents of /etc/machine-id, or the host's name where there is none.
FixedText<64> machine_id();

}  // namespace bess
