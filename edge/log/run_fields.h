// The table of what a run counts, beside that of a cycle (record_fields.h): status.json and metrics
// hold both.
#pragma once

#include "edge/log/record_fields.h"
#include "edge/log/run_status.h"

namespace bess {

consteval auto make_run_fields() {
  using T = RunTotals;
  return std::to_array<Field<RunTotals>>({
      {member<&T::cycles>(),
       "cycles",
       {.totals = 11, .metrics = {32, "bess_cycles_total"}},
       {"Cycles since the start."}},
      {member<&T::written_orders>(), "written_orders", {.totals = 13}},
      {member<&T::battery_failures>(), "battery_failures", {.totals = 31}},
      {member<&T::price_failures>(), "price_failures", {.totals = 32}},
      {member<&T::records_dropped>(),
       "records_dropped",
       {.totals = 41, .metrics = {37, "bess_log_records_dropped_total"}},
       {"Records lost because the disk was too slow."}},
      {member<&T::disk_failures>(),
       "disk_failures",
       {.totals = 42, .metrics = {38, "bess_log_failures_total"}},
       {"Records that a log file refused."}},
      {member<&T::disk_is_slow>(), "disk_is_slow", {.totals = 51}},
      {member<&T::disk_is_failing>(), "disk_is_failing", {.totals = 52}},
      {member<&T::run_folder_is_failing>(), "run_folder_is_failing", {.totals = 53}},
  });
}

inline constexpr auto kRunFields = make_run_fields();

}  // namespace bess
