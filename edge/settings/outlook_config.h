// [outlook]: whom to ask for day-ahead prices, for a student whose context is the outlook.
#pragma once

#include "edge/prices/outlook_settings.h"
#include "shared/host/toml_reader.h"

namespace bess {

void read_outlook(TomlTable table, OutlookSettings& outlook);

}  // namespace bess
