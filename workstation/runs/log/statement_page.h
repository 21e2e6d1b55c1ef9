// Statement of days as a printable, self-contained page, to compare with the bill.
#pragma once

#include <string>
#include <vector>

#include "workstation/runs/log/log_input.h"

namespace bess {

/// HTML that is also XML. `days` is not empty; costs and wear from `battery`.
std::string statement_page(const std::vector<LoggedDay>& days, const BatteryParameters& battery);

}  // namespace bess
