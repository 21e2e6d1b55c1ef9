// Which dataset to ask for which time. Elia keeps minute and quarter-hour prices apart, changed
// datasets with the market design, and publishes the running day in datasets of its own:
//   until 21 May 2024   ods046 minutes, ods047 quarter-hours
//   since 22 May 2024   ods133 minutes, ods134 quarter-hours      (both refreshed once a day)
//   today               ods161 minutes, ods162 quarter-hours      (near real time)
// The last days before today are a window of their own, because they may still be filling.
// All borders are local midnights. Long spans are cut by local month: an export has no row limit,
// but an offset would bring one back, so time windows are the only way to page.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "workstation/market/series/local_date.h"

namespace bess {

struct FetchWindow {
  std::string dataset;
  std::int64_t from_utc_s;
  std::int64_t until_utc_s;  ///< exclusive
  bool settles_later;        ///< may still be filling: a copy must not be kept
  friend bool operator==(const FetchWindow&, const FetchWindow&) = default;
};

struct FetchSpan {
  LocalDate from, to;  ///< both inclusive
};

/// A dataset that is refreshed all day; the others once a day.
bool is_near_real_time(std::string_view dataset);

/// A dataset of minutes; the others hold quarter-hours.
bool holds_minutes(std::string_view dataset);

/// Windows in order of time, quarter-hours after their minutes. Days after today are left out.
/// Throws UserError when nothing is left.
std::vector<FetchWindow> plan_fetch(const FetchSpan& span, std::int64_t now_utc_s);

}  // namespace bess
