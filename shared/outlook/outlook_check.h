// One number that says how a machine plans: the exporter writes it into the header, and every start
// on the edge finds it again.
#pragma once

#include <cstdint>

#include "shared/outlook/outlook_plan.h"

namespace bess {

/// Day-ahead prices of made-up days: a dear morning and evening, a cheap noon, a hole, and what is
/// never known, tomorrow evening.
OutlookDays made_up_outlook_days(std::int64_t utc_s);

/// Checksum of the break-even prices of the day on which summer time began in 2025, at five SoCs.
/// `plan` is overwritten. Needs the market's time zone.
std::uint32_t outlook_check(const OutlookModel& model, OutlookPlan& plan);

}  // namespace bess
