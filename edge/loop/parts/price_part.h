// What other prices have to do with this cycle: the level that student and full charge hold a price
// against, the outlook on later ones, and a price that stands still.
#pragma once

#include "edge/control/frozen_price.h"
#include "edge/control/full_charge.h"
#include "edge/loop/parts/cycle_part.h"

namespace bess {

struct FullChargePart : CyclePart {
  explicit FullChargePart(std::int32_t every_days) : charge(every_days) {}

  void restore(const CycleRecord& before) {
    level = before.price_level;
    charge.restore(last_full_day_of(before.utc_s, before.days_since_full));
  }
  void observe(const Reading& now) {
    if (!now.is_read || !now.ends_step()) return;
    charge.update(local_day_number(local_minute_of(now.utc_s)), now.response.measurement.soc_e4);
  }
  void put(const Moment& now, CycleRecord&, GuardInputs& in) {
    if (now.is_tick && in.has_price) {
      level.observe(in.price_minute_utc_s, in.price_centi_eur_per_mwh);
    }
    in.full_charge = charge.wish(in.price_centi_eur_per_mwh, level);
  }
  void report(CycleRecord& record) const {
    record.price_level = level;
    record.days_since_full = charge.days_since_full();
  }

  PriceLevel level;
  FullCharge charge;
};

struct OutlookPart : CyclePart {
  void restore(const CycleRecord& before) { planned_utc_s = before.outlook.planned_utc_s; }
  /// What the student's class is made of; the battery was read.
  std::int32_t context_centi(const PriceLevel& level, CycleRecord& record) {
    const std::int32_t level_centi = level.centi_eur_per_mwh();
    if (board == nullptr) return level_centi;
    record.outlook = outlook_at(*board, record.utc_s, record.measurement.soc_e4, level_centi);
    if (record.outlook.source == OutlookSource::kPlanned || planned_utc_s == 0) {
      planned_utc_s = record.utc_s;
    }
    return record.outlook.break_even_centi;
  }
  void report(CycleRecord& record) const { record.outlook.planned_utc_s = planned_utc_s; }

  OutlookBoard* board = nullptr;  ///< null unless the outlook is the student's context
  std::int64_t planned_utc_s = 0;
};

struct FrozenPricePart : CyclePart {
  explicit FrozenPricePart(const FrozenPriceSettings& settings) : frozen(settings) {}

  void restore(const CycleRecord& before) { frozen.restore(before.standing_price); }
  void recall(const CycleRecord& then, bool) {
    if (!then.price.has_row) return;
    frozen.recall(then.price.minute_utc_s, then.price.price_centi_eur_per_mwh);
  }
  void put(const Moment& now, CycleRecord&, GuardInputs& in) {
    if (now.is_tick && in.has_price) {
      frozen.observe(in.price_minute_utc_s, in.price_centi_eur_per_mwh);
    }
    in.price_is_frozen = frozen.is_no_price();
  }
  void report(CycleRecord& record) const {
    record.standing_price = frozen.price();
    record.price_frozen = frozen.is_frozen();
  }

  FrozenPrice frozen;
};

}  // namespace bess
