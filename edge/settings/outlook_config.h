// [outlook]: whom to ask for day-ahead prices, for a student whose context is the outlook.
#pragma once

#include "edge/outlook/day_ahead_feed.h"
#include "shared/host/toml_reader.h"

namespace bess {

void read_outlook(TomlTable table, OutlookSettings& outlook);

}  // namespace bess
