// What `bess-edge commission` found out, kept beside the other state: without it, or when map,
// variant or address have changed since, the battery is not controlled. Start-up only.
#pragma once

#include <string>

#include "edge/battery/commission.h"
#include "edge/program/edge_config.h"

namespace bess {

/// Written beside and renamed. False with one line in `error`.
bool write_commission_file(const EdgeConfig& config, const CommissionResult& result,
                           std::int64_t utc_s, std::string& error);

/// False with one line in `error`, which says what differs and how to mend it.
bool is_commissioned(const EdgeConfig& config, std::string& error);

}  // namespace bess
