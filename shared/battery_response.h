// Battery response to an order: dead time, ramp, first-order lag. Mean and final power of any time
// span have a closed form.
#pragma once

#include <cmath>

namespace bess {

struct PowerResponse {
  double delay_s = 0;          ///< dead time
  double ramp_w_per_s = 0;     ///< 0: immediate
  double time_constant_s = 0;  ///< of the first-order lag after the ramp; 0: none

  [[nodiscard]] constexpr bool exists() const {
    return delay_s > 0 || ramp_w_per_s > 0 || time_constant_s > 0;
  }
};

/// Output of the ramp, and of the lag after it.
struct PowerState {
  double ramped_w = 0;
  double flowing_w = 0;
};

struct ResponsePower {
  double mean_w;
  PowerState end;
};

/// Power within `seconds` (above 0) after an order of `wanted_w`; unchanged during the dead time.
inline ResponsePower response_power(const PowerResponse& response, PowerState from, double wanted_w,
                                    double seconds) {
  const double left_s = seconds - response.delay_s;
  if (left_s <= 0) return {from.flowing_w, from};
  const double step_w = wanted_w - from.ramped_w;
  const bool ramps = response.ramp_w_per_s > 0 && step_w != 0;
  const double ramp_s = ramps ? std::fabs(step_w) / response.ramp_w_per_s : 0.0;
  const double ramped_s = std::fmin(ramp_s, left_s);
  const double slope_w_per_s = ramps ? step_w / ramp_s : 0.0;
  const double end_w = ramped_s < ramp_s ? from.ramped_w + slope_w_per_s * ramped_s : wanted_w;
  double area_ws = ramped_s * (from.ramped_w + end_w) / 2 + (left_s - ramped_s) * wanted_w;
  double flowing_w = end_w;
  if (const double tau_s = response.time_constant_s; tau_s > 0) {
    // y' = (u - y) / tau: u - y approaches slope * tau on the ramp and 0 after it; the integral of
    // u - y is tau times the rise of y.
    const double behind_w = (ramps ? from.ramped_w : wanted_w) - from.flowing_w;
    const double on_ramp_w = slope_w_per_s * tau_s;
    const double at_top_w = on_ramp_w + (behind_w - on_ramp_w) * std::exp(-ramped_s / tau_s);
    flowing_w -= at_top_w * std::exp(-(left_s - ramped_s) / tau_s);
    area_ws -= tau_s * (flowing_w - from.flowing_w);
  }
  return {(response.delay_s * from.flowing_w + area_ws) / seconds, {end_w, flowing_w}};
}

}  // namespace bess
