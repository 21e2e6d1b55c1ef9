// The statement of some days as a page to print, whole in one file: to be held beside the bill.
#pragma once

#include <string>
#include <vector>

#include "workstation/runs/log/log_input.h"

namespace bess {

/// HTML that is XML as well. `days` are not empty; costs and wear are of `battery`.
std::string statement_page(const std::vector<LoggedDay>& days, const BatteryParameters& battery);

}  // namespace bess
