// Archive of steps for a page: prices, and actions of each policy; page/archive.js unpacks it. A
// day is one block of consecutive little-endian arrays:
//
//   minute int32 (UTC, since 1970) | observed int32 (hundredths of EUR/MWh, as the edge reads it)
//   | paid int32 (thousandths: a mean of two) | local minute of the day int16 | context class int8
//   and for each policy  profit float32 (EUR) | power float32 (W) | SoC int16 (1e-4, before)
//   | action int8
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/data/env/evaluate.h"

namespace bess {

/// Steps of one policy, in order.
struct PolicySteps {
  std::string name;
  std::vector<StepRecord> records;
};

using ClassOfStep = std::function<int(const MarketStep&)>;

/// {"policies": [...], "days": [{"date", "steps"}...], "data": base64 of the zlib stream}. Records
/// cover all `days`, in order; `kept` are the indices of the days to pack, ascending.
Json step_archive(const MarketSteps& market, const std::vector<MarketDay>& days,
                  const std::vector<PolicySteps>& policies, const std::vector<std::size_t>& kept,
                  const ClassOfStep& class_of);

/// RFC 4648, with padding.
std::string base64(std::string_view bytes);

}  // namespace bess
