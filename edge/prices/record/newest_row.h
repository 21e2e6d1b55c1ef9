// Newest usable price row of all requests for the control loop, with the check that holds a row
// after a large price step until the next row confirms it. No I/O, no clock.
#pragma once

#include <cstdint>
#include <cstdlib>

#include "edge/core/control/control_types.h"
#include "edge/prices/record/price_row.h"

namespace bess {

/// Step check: a single row does not move the battery. A price that differs from the previous one
/// by more than 2300 EUR/MWh waits until a later row within that step of it confirms it; a row
/// within the step of the previous one discards it; a row far from both replaces it. Pure integers.
class NewestRow {
 public:
  static constexpr std::int32_t kStepCentiEurPerMwh = 230'000;

  /// Result of a request, with its row for kOk.
  void publish(Status status, const PriceRow& row, std::int64_t received_monotonic_ns,
               std::int32_t fetch_us) {
    report_.status = status;
    if (status != Status::kOk) return;
    // A row older than the known one is from a stale cache.
    if (report_.has_row && row.minute_utc_s < report_.minute_utc_s) return;
    const bool is_newer = !report_.has_row || row.minute_utc_s > report_.minute_utc_s;
    if (!accept(row) || !is_newer) return;
    report_.received_monotonic_ns = received_monotonic_ns;
    report_.fetch_us = fetch_us;
  }
  [[nodiscard]] const PriceReport& report() const { return report_; }

 private:
  [[nodiscard]] static bool is_large_step(std::int32_t from_centi, std::int32_t to_centi) {
    return std::abs(to_centi - from_centi) > kStepCentiEurPerMwh;
  }
  /// Takes a newer minute, or the same one: a duplicate changes nothing, a correction replaces the
  /// price. False if the previous row stays: duplicate, or pending.
  [[nodiscard]] bool accept(const PriceRow& row) {
    const bool is_duplicate = report_.has_row && row.minute_utc_s == report_.minute_utc_s &&
                              row.price_centi_eur_per_mwh == report_.price_centi_eur_per_mwh;
    // A row older than the pending one is from a stale cache.
    const bool is_stale = report_.step_held && row.minute_utc_s < held_minute_utc_s_;
    if (is_duplicate || is_stale) return false;
    const bool is_large = report_.has_row && is_large_step(report_.price_centi_eur_per_mwh,
                                                           row.price_centi_eur_per_mwh);
    const bool is_confirmed =
        report_.step_held && row.minute_utc_s > held_minute_utc_s_ &&
        !is_large_step(report_.held_centi_eur_per_mwh, row.price_centi_eur_per_mwh);
    report_.step_held = is_large && !is_confirmed;
    report_.held_centi_eur_per_mwh = report_.step_held ? row.price_centi_eur_per_mwh : 0;
    held_minute_utc_s_ = row.minute_utc_s;
    if (report_.step_held) return false;
    report_.large_step = is_large;
    report_.has_row = true;
    report_.minute_utc_s = row.minute_utc_s;
    report_.price_centi_eur_per_mwh = row.price_centi_eur_per_mwh;
    return true;
  }

  PriceReport report_;
  std::int64_t held_minute_utc_s_ = 0;  ///< of the row that waits
};

}  // namespace bess
