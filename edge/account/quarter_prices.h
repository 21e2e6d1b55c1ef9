// What quarter-hours are paid at: the settled price where it is published, else, as an estimate,
// the newest of the minutes that the log saw of it. The same for the battery and for everybody
// that it is held against.
#pragma once

#include <cstdint>
#include <map>
#include <optional>

#include "edge/account/settled_prices.h"
#include "edge/control/control_types.h"

namespace bess {

class QuarterPrices {
 public:
  explicit QuarterPrices(const SettledPrices& settled) : settled_(settled) {}

  /// In any order; the minutes of a quarter-hour's end are seen by the first record behind it.
  void note(const CycleRecord& record);

  /// Of the quarter-hour that holds the instant. None: neither published, nor seen.
  [[nodiscard]] std::optional<SettledQuarter> find(std::int64_t utc_s) const;
  /// For a cycle's two minutes of the same power from then on.
  [[nodiscard]] std::optional<double> of_step_eur_per_mwh(std::int64_t from_utc_s) const;

 private:
  struct Minute {
    std::int64_t utc_s = 0;
    double eur_per_mwh = 0;
  };

  const SettledPrices& settled_;
  std::map<std::int64_t, Minute> newest_;  ///< by the start of the quarter-hour
};

}  // namespace bess
