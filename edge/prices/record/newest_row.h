// Newest usable price row of all requests for the control loop, with the check that holds a row
// after a large price step until the next row confirms it. No I/O, no clock.
#pragma once

#include <cstdint>

#include "edge/core/control/control_types.h"
#include "edge/prices/record/price_row.h"

namespace bess {

// Step check: a single row does not move the battery. A price that differs from the previous one by
// more than 2300 EUR/MWh waits until the next row confirms it. Pure integers.

class StepHold {
 public:
  static constexpr std::int32_t kStepCentiEurPerMwh = 230'000;

  struct Verdict {
    bool is_taken = false;
    bool is_large_step = false;  ///< differs by more than that
  };

  /// Judges a row that is not older than `before`, the newest accepted one. A later row within the
  /// step of the pending row confirms it; a row within the step of `before` discards it; a row far
  /// from both replaces it. A row older than the pending one is from a stale cache.
  constexpr Verdict judge(const PriceRow& before, const PriceRow& row) {
    if (has_held_ && row.minute_utc_s < held_.minute_utc_s) return {};
    if (!is_large(before, row)) return take(false);
    const bool is_confirmed =
        has_held_ && row.minute_utc_s > held_.minute_utc_s && !is_large(held_, row);
    if (is_confirmed) return take(true);
    held_ = row;
    has_held_ = true;
    return {};
  }

  [[nodiscard]] constexpr bool has_held() const { return has_held_; }
  /// Valid only while a row is pending.
  [[nodiscard]] constexpr const PriceRow& held() const { return held_; }

 private:
  [[nodiscard]] static constexpr bool is_large(const PriceRow& from, const PriceRow& to) {
    const std::int32_t step = to.price_centi_eur_per_mwh - from.price_centi_eur_per_mwh;
    return (step < 0 ? -step : step) > kStepCentiEurPerMwh;
  }
  constexpr Verdict take(bool is_large_step) {
    has_held_ = false;
    return {.is_taken = true, .is_large_step = is_large_step};
  }

  bool has_held_ = false;
  PriceRow held_;
};

class NewestRow {
 public:
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
  /// Takes a newer minute, or the same one: a duplicate changes nothing, a correction replaces the
  /// price. False if the previous row stays: duplicate, or pending.
  [[nodiscard]] bool accept(const PriceRow& row) {
    const PriceRow before{.minute_utc_s = report_.minute_utc_s,
                          .price_centi_eur_per_mwh = report_.price_centi_eur_per_mwh};
    const bool is_duplicate = report_.has_row && row.minute_utc_s == before.minute_utc_s &&
                              row.price_centi_eur_per_mwh == before.price_centi_eur_per_mwh;
    if (is_duplicate) return false;
    const StepHold::Verdict verdict = step_hold_.judge(report_.has_row ? before : row, row);
    report_.step_held = step_hold_.has_held();
    report_.held_centi_eur_per_mwh =
        report_.step_held ? step_hold_.held().price_centi_eur_per_mwh : 0;
    if (!verdict.is_taken) return false;
    report_.large_step = verdict.is_large_step;
    report_.has_row = true;
    report_.minute_utc_s = row.minute_utc_s;
    report_.price_centi_eur_per_mwh = row.price_centi_eur_per_mwh;
    return true;
  }

  PriceReport report_;
  StepHold step_hold_;
};

}  // namespace bess
