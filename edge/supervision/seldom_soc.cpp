#include "edge/supervision/seldom_soc.h"

#include <algorithm>
#include <cstdlib>

namespace bess {
namespace {

constexpr std::int64_t kIntervalMaxS = 3'600;

}  // namespace

void SeldomSoc::begin(const Response& now) {
  path_.begin(now.steady_s);
  noted_s_ = now.steady_s;
  now_ = before_ = reading_of(now, INT64_MIN / 2);
  restart_interval();
  restart_standstill();
}

void SeldomSoc::note_power(const Response& now, std::int32_t power_before_w) {
  const std::int64_t seconds = std::max<std::int64_t>(now.steady_s - noted_s_, 0);
  const std::int64_t of_order_s = std::clamp<std::int64_t>(now.order_age_s, 0, seconds);
  const std::int32_t power_w = now.measurement.power_w;
  path_.add(now.steady_s - of_order_s, power_before_w);
  path_.add(now.steady_s, power_w);
  moved_ws_ += std::abs(std::int64_t{power_before_w}) * (seconds - of_order_s) +
               std::abs(std::int64_t{power_w}) * of_order_s;
  noted_s_ = now.steady_s;
}

void SeldomSoc::observe(const Response& now) {
  before_ = now_;
  const bool is_new = now.measurement.soc_e4 != before_.soc_e4;
  now_ = reading_of(now, is_new ? before_.steady_s : INT64_MIN / 2);
  ++still_readings_;
  if (is_new) restart_standstill();
}

/// The battery may follow as late as it settles, and show it as late as it refreshes.
SeldomSoc::Reading SeldomSoc::reading_of(const Response& now,
                                         std::int64_t refreshed_after_s) const {
  const std::int64_t refreshed_s =
      std::max(now.steady_s - settings_.band.soc_refresh_s, refreshed_after_s);
  return {.steady_s = now.steady_s,
          .soc_e4 = now.measurement.soc_e4,
          .energy = path_.since(refreshed_s - settings_.band.settle_s, settings_.power_w),
          .energy_ws = path_.energy_ws(),
          .moved_ws = moved_ws_};
}

bool SeldomSoc::take_interval(Interval& interval) {
  interval = {.energy_ws = now_.energy_ws - from_.energy_ws,
              .surely_ws = now_.energy.since(from_.energy).surely_ws(),
              .soc_e4 = now_.soc_e4 - from_.soc_e4,
              .seconds = now_.steady_s - from_.steady_s};
  const std::int64_t energy_ws = std::abs(interval.energy_ws);
  const bool is_sure = std::abs(interval.surely_ws) * 4 >= energy_ws * 3 &&
                       (interval.surely_ws < 0) == (interval.energy_ws < 0);
  const bool is_one_way = (now_.moved_ws - from_.moved_ws) * 2 <= energy_ws * 3;
  if (energy_ws == 0 || !is_sure || !is_one_way) return false;
  restart_interval();
  return true;
}

bool SeldomSoc::is_too_long() const { return now_.steady_s - from_.steady_s > kIntervalMaxS; }

}  // namespace bess
