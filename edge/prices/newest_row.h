// The newest usable price row so far, out of all that requests have brought: what the control loop
// is told. No io and no time of its own. Between price_json, which reads an answer, and price_feed.
#pragma once

#include "edge/control/control_types.h"
#include "edge/prices/price_row.h"
#include "edge/prices/step_hold.h"

namespace bess {

class NewestRow {
 public:
  /// How a request ended, and its row when that is kOk.
  void publish(Status status, const PriceRow& row, std::int64_t received_monotonic_ns,
               std::int32_t fetch_us) {
    report_.status = status;
    if (status != Status::kOk) return;
    // An older row than the one known is a stale cache talking.
    if (report_.has_row && row.minute_utc_s < report_.minute_utc_s) return;
    const bool is_newer = !report_.has_row || row.minute_utc_s > report_.minute_utc_s;
    if (!accept(row) || !is_newer) return;
    report_.received_monotonic_ns = received_monotonic_ns;
    report_.fetch_us = fetch_us;
  }
  [[nodiscard]] const PriceReport& report() const { return report_; }

 private:
  /// A newer minute, or the same one: a duplicate changes nothing, a correction replaces the price.
  /// False when the row before stays: this one is a duplicate, or is held.
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
