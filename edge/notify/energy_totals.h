// What the battery has charged and discharged since the notifier first looked: two counters that
// only grow, over restarts of notifier and controller, for whoever draws energy by the day (Home
// Assistant).
//
// A record's power stands for the two minutes that end at its tick, as in day_account.h, but never
// for time that an earlier record stands for already. Where no record is, or none with a
// measurement, nothing is counted.
#pragma once

#include <cstdint>

#include "edge/control/control_types.h"
#include "edge/log/log_reader.h"

namespace bess {

/// Kept over restarts as it is: what follows in the ring gives the same sums whenever it is
/// counted.
struct EnergyTotals {
  std::int64_t charged_ws = 0;
  std::int64_t discharged_ws = 0;
  std::uint64_t counted_number = 0;  ///< of the newest record that is in the sums
  std::int64_t counted_utc_s = 0;    ///< its tick; 0 = nothing was ever counted

  /// The first look counts nothing: it is where the counters begin.
  void count_new(const LogReader& log);

  [[nodiscard]] bool has_begun() const { return counted_utc_s != 0; }
  [[nodiscard]] double charged_kwh() const;
  [[nodiscard]] double discharged_kwh() const;

 private:
  void count(const CycleRecord& record);
};

}  // namespace bess
