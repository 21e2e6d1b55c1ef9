// All that has a say in a cycle, one row each, in the order in which it is asked
// (parts/cycle_part.h has the face).
#pragma once

#include <tuple>

#include "edge/loop/control_settings.h"
#include "edge/loop/parts/operator_parts.h"
#include "edge/loop/parts/price_part.h"
#include "edge/loop/parts/site_part.h"
#include "edge/loop/parts/supervision_part.h"
#include "edge/loop/parts/wear_part.h"

namespace bess {

template <typename Site>
auto parts_of(const ControlSettings& settings, const Site& site) {
  return std::tuple(SitePart<Site>(site),                              //
                    HoldPart(),                                        //
                    ReservePart(settings.reserve),                     //
                    FullChargePart(settings.full_charge_every_days),   //
                    OutlookPart(),                                     //
                    FrozenPricePart(settings.frozen_price),            //
                    CycleBudgetPart(settings.cycles_per_day_max_e4),   //
                    ReversalCapPart(settings.reversals_per_hour_max),  //
                    SupervisionPart(settings.supervision, settings.read_lead_s));
}

template <typename Site>
class CycleParts {
 public:
  CycleParts(const ControlSettings& settings, const Site& site)
      : parts_(parts_of(settings, site)) {}

  void restore(const CycleRecord& before) {
    each([&](auto& part) { part.restore(before); });
  }
  void recall(const CycleRecord& then, bool is_under_control) {
    each([&](auto& part) { part.recall(then, is_under_control); });
  }
  void observe(const Reading& now) {
    each([&](auto& part) { part.observe(now); });
  }
  void put(const Moment& now, CycleRecord& record, GuardInputs& in) {
    each([&](auto& part) { part.put(now, record, in); });
  }
  void note(std::int32_t power_w) {
    each([&](auto& part) { part.note(power_w); });
  }
  void report(CycleRecord& record) const {
    std::apply([&](const auto&... part) { (part.report(record), ...); }, parts_);
  }

  template <typename Part>
  [[nodiscard]] Part& get() {
    return std::get<Part>(parts_);
  }
  template <typename Part>
  [[nodiscard]] const Part& get() const {
    return std::get<Part>(parts_);
  }

 private:
  template <typename Say>
  void each(const Say& say) {
    std::apply([&](auto&... part) { (say(part), ...); }, parts_);
  }

  decltype(parts_of(std::declval<const ControlSettings&>(), std::declval<const Site&>())) parts_;
};

}  // namespace bess
