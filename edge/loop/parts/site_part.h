// House, connection and outside limits; first of all, for a limit of another part is within them.
#pragma once

#include "edge/loop/parts/cycle_part.h"

namespace bess {

template <typename Site>
struct SitePart : CyclePart {
  explicit SitePart(const Site& of) : site(of) {}

  void restore(const CycleRecord& before) { site.take_over(before.utc_s, before.site); }
  void observe(const Reading& now) {
    if (now.look != Look::kTick && now.look != Look::kCheck) return;
    const Response& response = now.response;
    site.observe(response.utc_s, now.is_read, response.measurement,
                 {.is_driven = now.is_read && response.is_driven, .age_s = response.order_age_s});
  }
  void put(const Moment& now, CycleRecord&, GuardInputs& in) {
    in.site = site.range(in.now_utc_s, now.power_w, now.margin);
  }
  void report(CycleRecord& record) const { record.site = site.report(record.utc_s); }

  Site site;
};

}  // namespace bess
