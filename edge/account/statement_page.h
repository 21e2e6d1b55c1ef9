// The statement of some days as a page to print, whole in one file: to be held beside the bill.
#pragma once

#include <string>

#include "edge/account/statement.h"
#include "edge/account/stops.h"

namespace bess {

/// HTML that is XML as well. `statement` has at least a day.
std::string statement_page(const Statement& statement, const Stops& stops);

}  // namespace bess
