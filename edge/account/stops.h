// What kept the student from deciding, for how long, and what that cost: by reasons.
//
// The cost is an estimate: what the student, undisturbed, would have earned in those very cycles
// from the charge that the battery had when they began, less what was earned in them, both at the
// price of their quarter-hours; what either stores besides counts at the mean price of all days. A
// cycle without a price or without a reading has no cost that could be told; such cycles are
// counted. Below zero the stop has earned.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "edge/account/drive.h"
#include "edge/log/log_reader.h"
#include "shared/host/json.h"

namespace bess {

struct Stop {
  Reason reason = Reason::kStudent;
  int cycles = 0;
  int not_driven = 0;  ///< of them, with the battery at 0 W or in its own mode
  int valued = 0;      ///< of them, those that the cost is of
  double cost_eur = 0;
};

struct Stops {
  std::vector<Stop> by_reason;  ///< the dearest first
  int missing_cycles = 0;       ///< ticks without a record: nobody ran, or the clock was stepped
  int cycles = 0;               ///< of all days, the missing ones not among them
  int driven_cycles = 0;

  [[nodiscard]] double cost_eur() const;
  /// Of the time from the first record to the last.
  [[nodiscard]] double driven_share() const;
};

/// Of a run of records, oldest first; `prices` are of all of them.
class StopBook {
 public:
  StopBook(const BatteryParameters& battery, const PriceThresholds& thresholds,
           const QuarterPrices& prices)
      : battery_(battery), thresholds_(thresholds), prices_(prices) {}

  void add(const CycleRecord& record);
  [[nodiscard]] Stops stops() const;

 private:
  struct Cycle {
    PricedCycle priced{};
    std::int32_t power_w = 0;
    std::int32_t soc_e4 = -1;  ///< -1: not measured
    Reason reason = Reason::kStudent;
    bool is_driven = false;
    bool has_price = false;
  };
  [[nodiscard]] double mean_eur_per_mwh() const;
  void value(std::size_t first, std::size_t end, double mean_eur_per_mwh, Stop& stop) const;

  BatteryParameters battery_;
  PriceThresholds thresholds_;
  const QuarterPrices& prices_;
  std::vector<Cycle> cycles_;
};

/// Of the days from `first_day` to `last_day`, as 20231126.
Stops stops_of_days(const LogReader& log, std::int32_t first_day, std::int32_t last_day,
                    const BatteryParameters& battery, const PriceThresholds& thresholds,
                    const QuarterPrices& prices);

/// Lines, ended; nothing where nothing stopped it.
std::string stops_text(const Stops& stops);
Json stops_json(const Stops& stops);

}  // namespace bess
