// What an operator asks of a cycle: a hold, and a reserve at this hour.
#pragma once

#include "edge/control/hold.h"
#include "edge/control/reserve.h"
#include "edge/loop/parts/cycle_part.h"

namespace bess {

struct HoldPart : CyclePart {
  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    if (now.is_tick && mailbox != nullptr) record.hold = hold_at(mailbox->latest(), record.utc_s);
    in.held = record.hold.held;
    in.held_power_w = record.hold.power_w;
  }

  const HoldMailbox* mailbox = nullptr;
};

struct ReservePart : CyclePart {
  explicit ReservePart(const ReservePlan& of_day) : plan(of_day) {}

  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    if (now.is_tick) {
      soc_e4 = reserve_soc_e4_at(plan, local_minute_of(record.utc_s));
      record.reserve_soc_e4 = soc_e4;
    }
    in.reserve_soc_e4 = soc_e4;
  }

  ReservePlan plan;
  std::int16_t soc_e4 = 0;  ///< of this hour; 0 = none
};

}  // namespace bess
