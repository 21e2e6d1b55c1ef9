// Price unit check, pure, over the incoming rows. Thresholds from data: correct minutes of 2023 to
// 2025 never stay within 2 EUR/MWh for 15 minutes, settled quarter-hours never for 2.5 hours; in
// EUR/kWh every hour does, with three or more decimals.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstdlib>

#include "edge/prices/fetch/price_json.h"
#include "shared/units_and_limits.h"

namespace bess {

class UnitWatch {
 public:
  /// Takes a newer row; older ones are ignored.
  void observe(const PriceRow& row) {
    if (row.minute_utc_s <= newest_utc_s_) return;
    newest_utc_s_ = row.minute_utc_s;
    const std::int32_t size_centi = std::abs(row.price_centi_eur_per_mwh);
    count(small_, size_centi <= kSmallCenti, row);
    count(large_, size_centi >= kLargeCenti, row);
    has_jumped_ = small_.rows >= kJumpRows && (has_jumped_ || is_jump(row));
    if (small_.rows == 0) usual_centi_ = size_centi;
  }
  /// Certainly or most likely another unit: must not be traded on.
  [[nodiscard]] bool is_doubtful() const {
    const bool is_fine = small_.finer * 4 >= small_.rows;
    return has_jumped_ || (small_.varies && small_.lasts_s() >= (is_fine ? kHourS : 3 * kHourS)) ||
           (large_.varies && large_.lasts_s() >= 3 * kHourS);
  }

 private:
  static constexpr std::int32_t kSmallCenti = 2 * kCentiPerEur, kLargeCenti = 1'500 * kCentiPerEur;
  static constexpr std::int64_t kHourS = 3'600;
  static constexpr int kJumpRows = 3;

  struct Run {
    std::int64_t from_utc_s = 0, until_utc_s = 0;
    std::int32_t first_centi = 0;
    int rows = 0, finer = 0;
    bool varies = false;
    [[nodiscard]] std::int64_t lasts_s() const { return until_utc_s - from_utc_s; }
  };

  static void count(Run& run, bool is_within, const PriceRow& row) {
    if (!is_within) return static_cast<void>(run = {});
    if (run.rows++ == 0) {
      run.from_utc_s = row.minute_utc_s;
      run.first_centi = row.price_centi_eur_per_mwh;
    }
    run.until_utc_s = row.minute_utc_s + 60;
    run.varies = run.varies || row.price_centi_eur_per_mwh != run.first_centi;
    run.finer += row.is_finer_than_cents ? 1 : 0;
  }
  /// From one row to the next a thousandth, and finer than cents: EUR/kWh from now on.
  [[nodiscard]] bool is_jump(const PriceRow& row) const {
    const double ratio = usual_centi_ / std::fmax(std::abs(row.price_centi_eur_per_mwh), 0.5);
    return small_.finer == small_.rows && ratio > 300 && ratio < 3'000;
  }

  std::int64_t newest_utc_s_ = 0;
  Run small_, large_;
  std::int32_t usual_centi_ = 0;  ///< magnitude of the last row that was not small
  bool has_jumped_ = false;
};

}  // namespace bess
