// Settled prices of quarter-hours, as billed: written by bess-prices once a day. A text with one
// line per quarter-hour and a checksum at its end, replaced atomically.
//   2026-11-23T22:45:00Z,131.07,published
// A quarter-hour is published on the next day and may change until it is validated, after the 15th
// of the next month. Other quarter-hours have only indicative prices.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/exchange.h"

namespace bess {

class SettledPrices {
 public:
  /// Adds prices in any order. Newer ones replace older ones, but published ones no validated ones.
  void put(std::span<const SettledQuarter> quarters);
  void drop_before(std::int64_t utc_s);
  /// Null if not published yet.
  [[nodiscard]] const SettledQuarter* find(std::int64_t utc_s) const;
  [[nodiscard]] const std::vector<SettledQuarter>& quarters() const { return quarters_; }
  /// First quarter-hour from `utc_s` that is not validated, known or not.
  [[nodiscard]] std::int64_t first_open(std::int64_t utc_s) const;

  [[nodiscard]] std::string text() const;
  /// False, and no prices, for another or damaged text.
  bool parse(std::string_view text);
  /// Empty without a file or without an error; else one line, and no prices.
  std::string read(const std::string& path);

 private:
  std::vector<SettledQuarter> quarters_;  ///< by time
};

/// Days of quarter-hours that are kept, days of 25 hours included.
inline constexpr int kSettledDaysMax = 100;

/// Input for earnings.
struct MoneyTerms {
  SettledPrices settled{};
  std::int32_t capacity_wh = 0;  ///< of a device that reports none
};
}  // namespace bess
