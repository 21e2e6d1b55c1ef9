// JSON data of the report page's scripts (page/*.js): days of all policies, steps, integer students
// and training curves.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "workstation/report/figures/html.h"
#include "workstation/report/report.h"

namespace bess {

// Archive of steps: prices, and actions of each policy; page/archive.js unpacks
// it. A day is one block of consecutive little-endian arrays:
//
//   minute int32 (UTC, since 1970) | observed int32 (hundredths of EUR/MWh, as the edge reads it)
//   | paid int32 (thousandths: a mean of two) | local minute of the day int16 | context class int8
//   and for each policy  profit float32 (EUR) | power float32 (W) | SoC int16 (1e-4, before)
//   | action int8

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

/// Maximum number of days with steps, so that the page stays below 5 MB: the worst and the newest.
inline constexpr std::size_t kDaysWithSteps = 250;
/// Of these, days with the largest gap of the exported policy to foresight.
inline constexpr std::size_t kWorstDaysKept = 25;

/// Indices of the days to keep, ascending; `profit_eur` by day, in time order.
std::vector<std::size_t> days_with_steps(const std::vector<double>& profit_eur, std::size_t most);

/// Steps of the run's own policies on the test days.
struct PageSteps {
  std::vector<MarketDay> days;        ///< all test days
  std::vector<PolicySteps> policies;  ///< on all of them; the exported policy first
  std::vector<std::size_t> kept;      ///< indices of the days on the page, ascending
};
PageSteps page_steps(const RunResults& run);

Json page_data(const RunResults& run, const PageSteps& steps);

// CSV data of pictures that no other file of the run contains: steps, initial maps and prices.
// foresight_gap.h has its own; days, checkpoints and losses are in evaluation_days.csv,
// training_curve.csv, student_checkpoints.csv and distil_curve.csv.

std::vector<PictureFile> page_pictures(const RunResults& run, const PageSteps& steps);

/// Name of a run's teacher: "c51 teacher".
std::string teacher_name(const Teacher& teacher);

/// Name of a run's own student: kCorrectedName, or kUnprovedName if it has violations.
const char* own_student_name(const Certificate& certificate);

}  // namespace bess
