// Prices of quarter-hours as they are billed: written by bess-prices once a day, read by whoever
// counts money. A text of one line a quarter-hour, with a checksum at its end, replaced at once.
//   2026-11-23T22:45:00Z,131.07,published
// A quarter-hour is published on the day after, and may change until it is validated, after the
// 15th of the next month. One that is not in the file is known by its minutes alone: indicative.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "shared/host/exchanged_days.h"
#include "shared/host/toml_reader.h"

namespace bess {

class SettledPrices {
 public:
  /// Newer ones count; what is validated is never published again. In any order.
  void put(std::span<const SettledQuarter> quarters);
  void drop_before(std::int64_t utc_s);
  /// Null: not published yet.
  [[nodiscard]] const SettledQuarter* find(std::int64_t utc_s) const;
  [[nodiscard]] const std::vector<SettledQuarter>& quarters() const { return quarters_; }
  /// The first from `utc_s` on that is not validated, known or not; `utc_s` as a quarter-hour's.
  [[nodiscard]] std::int64_t first_open(std::int64_t utc_s) const;

  [[nodiscard]] std::string text() const;
  /// False when it is no such text, or damaged; then nothing is known.
  bool parse(std::string_view text);
  /// Empty where there is no file, or all is well; else one line, and nothing is known.
  std::string read(const std::string& path);

 private:
  std::vector<SettledQuarter> quarters_;  ///< by time
};

/// So many quarter-hours are kept: 100 days, with those of 25 hours among them.
inline constexpr int kSettledDaysMax = 100;

// What of the configuration counts money: where bess-prices keeps settled prices, and the capacity
// of a battery that does not tell its own. Read apart from the controller's settings.

struct MoneySettings {
  std::int32_t capacity_wh = 8'000;  ///< [battery] capacity_wh
  std::string settled_file;          ///< of bess-prices; there may be none
};

/// `root` is the whole configuration, whose slips others name.
MoneySettings read_money_settings(TomlTable& root);

/// What is counted with.
struct MoneyTerms {
  SettledPrices settled{};
  std::int32_t capacity_wh = 0;  ///< of a device that tells none
};
/// With what lies in the file of settled prices; `trouble` is one line when that cannot be read.
MoneyTerms money_terms(const MoneySettings& settings, std::string& trouble);

}  // namespace bess
