// Battery model: one step as a pure function [Paper, Eq. 2, 4, 5; SPEC 3].
//   SoC' = SoC + (max(p,0) * eta_charge + min(p,0) / eta_discharge - r * p^2 / P) * dt / C
// p is the average power really exchanged over the step, limited by the SoC bounds. In the paper
// r = 0.
#pragma once

#include <cmath>

#include "shared/units_and_limits.h"

namespace bess {

/// Response to an order: dead time, ramp, first-order lag. Mean and final power of any time span
/// have a closed form.
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

// Costs of buying and selling a MWh in addition to its price: grid fees, taxes, the supplier's
// margin.
//   import price = price + adder + percent of |price|
//   export price = price - fee   - percent of |price|
// The percentage applies to the absolute price, so it is always a cost: at -100 EUR/MWh and 5 %
// import earns 95 EUR/MWh and export costs 105 EUR/MWh.

struct TradingCosts {
  double import_adder_eur_per_mwh = 0;
  double import_percent = 0;  ///< of |price|
  double export_fee_eur_per_mwh = 0;
  double export_percent = 0;  ///< of |price|

  /// Cost of a MWh imported at this price.
  [[nodiscard]] constexpr double import_eur_per_mwh(double price_eur_per_mwh) const {
    return price_eur_per_mwh +
           (import_adder_eur_per_mwh + import_percent / 100 * size_of(price_eur_per_mwh));
  }
  /// Revenue of a MWh exported at this price.
  [[nodiscard]] constexpr double export_eur_per_mwh(double price_eur_per_mwh) const {
    return price_eur_per_mwh -
           (export_fee_eur_per_mwh + export_percent / 100 * size_of(price_eur_per_mwh));
  }

 private:
  static constexpr double size_of(double price) { return price < 0 ? -price : price; }
};

/// Power reduction near a bound of the SoC window: linear from full power at `width_frac` before
/// the bound to `share` at the bound. A width of 0: none.
struct PowerTaper {
  double width_frac = 0;
  double share = 1;

  /// Share of the power at this distance from the bound.
  [[nodiscard]] constexpr double at(double room_frac) const {
    if (room_frac >= width_frac) return 1;
    return room_frac <= 0 ? share : share + (1 - share) * room_frac / width_frac;
  }
};

/// Reduced power in cold hours of the local day, which may include midnight.
struct ColdHours {
  double power_share = 1;  ///< share of the power, both directions; 1: no cold hours
  double from_hour = 0;
  double to_hour = 0;

  [[nodiscard]] constexpr bool exist() const { return power_share < 1; }
  /// `quarter_hour`: local, 0 to 95.
  [[nodiscard]] constexpr bool hold(int quarter_hour) const {
    const double hour = quarter_hour / 4.0;
    const bool is_after = hour >= from_hour, is_before = hour < to_hour;
    return exist() && (from_hour <= to_hour ? is_after && is_before : is_after || is_before);
  }
  [[nodiscard]] constexpr double share_at(int quarter_hour) const {
    return hold(quarter_hour) ? power_share : 1;
  }
};

struct BatteryParameters {
  double power_w_max = 4e6;                       ///< P, grid side, both directions
  double capacity_wh = 8e6;                       ///< C
  double charge_efficiency = 0.9486832980505138;  ///< sqrt(0.9): 90 % round trip
  double discharge_efficiency = 0.9486832980505138;
  double soc_min_frac = 0.10;
  double soc_max_frac = 1.00;
  // Not in the paper's model.
  PowerTaper charge_taper{};        ///< towards soc_max
  PowerTaper discharge_taper{};     ///< towards soc_min
  double full_power_loss_frac = 0;  ///< r: additional loss at full power, quadratic in power
  double standby_w = 0;             ///< own consumption from the grid
  PowerResponse response{};         ///< from an order to its power
  ColdHours cold{};                 ///< applied by callers of battery_step
  // Costs and limits of use, for accounting and planning, not for battery_step.
  double wear_eur_per_mwh = 0;    ///< of throughput: charged and discharged energy, grid side
  TradingCosts costs{};           ///< in addition to the price
  double cycles_per_day_max = 0;  ///< full cycles per local day; 0: no limit
  // Used by the environment only, not by planning and learning.
  double fade_percent_per_1000_cycles = 0;  ///< of the remaining capacity
  double minimum_run_min = 0;               ///< minimum time of an ordered direction

  /// Maximum power in a local quarter-hour of the day.
  [[nodiscard]] constexpr double power_w_at(int quarter_hour) const {
    return power_w_max * cold.share_at(quarter_hour);
  }
};

/// Whether full power moves the same energy in each step of an hour away from the bounds.
constexpr bool has_constant_power(const BatteryParameters& battery) {
  return battery.charge_taper.width_frac == 0 && battery.discharge_taper.width_frac == 0 &&
         battery.full_power_loss_frac == 0;
}

struct BatteryStep {
  double power_w;   ///< average over the step, grid side, charge positive
  double soc_frac;  ///< at the end of the step
};

/// Power at the cells, W, charge positive.
inline double stored_power_w(const BatteryParameters& battery, double power_w) {
  const double lossless_w =
      power_w > 0 ? power_w * battery.charge_efficiency : power_w / battery.discharge_efficiency;
  return lossless_w - battery.full_power_loss_frac * power_w * power_w / battery.power_w_max;
}

/// Step with r > 0: the power at the cells is quadratic in the grid power.
inline BatteryStep lossy_step(const BatteryParameters& battery, double soc_frac, double power_w,
                              double hours) {
  const bool charges = power_w > 0;
  const double bound_frac = charges ? battery.soc_max_frac : battery.soc_min_frac;
  const double slope = charges ? battery.charge_efficiency : 1 / battery.discharge_efficiency;
  const double square = battery.full_power_loss_frac / battery.power_w_max;
  const double fits_stored_w = (bound_frac - soc_frac) * battery.capacity_wh / hours;
  const bool has_room = charges ? fits_stored_w > 0 : fits_stored_w < 0;
  if (power_w == 0 || !has_room) return {0.0, soc_frac};
  const double stored_w = stored_power_w(battery, power_w);
  if (std::fabs(stored_w) < std::fabs(fits_stored_w)) {
    return {power_w, soc_frac + stored_w * hours / battery.capacity_wh};
  }
  const double root = std::sqrt(slope * slope - 4 * square * fits_stored_w);
  return {(slope - root) / (2 * square), bound_frac};
}

/// Exchanges up to `wanted_power_w` for `hours`. Stays within [soc_min, soc_max]; a battery that
/// starts outside only moves towards the window or idles. The taper uses the SoC before the step.
inline BatteryStep battery_step(const BatteryParameters& battery, double soc_frac,
                                double wanted_power_w, double hours) {
  const double charge_w_max =
      battery.power_w_max * battery.charge_taper.at(battery.soc_max_frac - soc_frac);
  const double discharge_w_max =
      battery.power_w_max * battery.discharge_taper.at(soc_frac - battery.soc_min_frac);
  const double power_w = wanted_power_w > charge_w_max       ? charge_w_max
                         : wanted_power_w < -discharge_w_max ? -discharge_w_max
                                                             : wanted_power_w;
  if (battery.full_power_loss_frac > 0) return lossy_step(battery, soc_frac, power_w, hours);
  if (power_w > 0) {
    const double room_wh = (battery.soc_max_frac - soc_frac) * battery.capacity_wh;
    const double fits_w = room_wh > 0 ? room_wh / (battery.charge_efficiency * hours) : 0.0;
    if (power_w >= fits_w) return {fits_w, fits_w > 0 ? battery.soc_max_frac : soc_frac};
    return {power_w, soc_frac + power_w * battery.charge_efficiency * hours / battery.capacity_wh};
  }
  if (power_w < 0) {
    const double stored_wh = (soc_frac - battery.soc_min_frac) * battery.capacity_wh;
    const double fits_w = stored_wh > 0 ? -stored_wh * battery.discharge_efficiency / hours : 0.0;
    if (power_w <= fits_w) return {fits_w, fits_w < 0 ? battery.soc_min_frac : soc_frac};
    return {power_w,
            soc_frac + power_w / battery.discharge_efficiency * hours / battery.capacity_wh};
  }
  return {0.0, soc_frac};
}

/// Step with power response: includes the power state before and after the step. At a bound the
/// power ends at 0.
struct ResponseStep {
  BatteryStep step;
  PowerState power;
};
inline ResponseStep response_step(const BatteryParameters& battery, double soc_frac,
                                  PowerState power, double wanted_power_w, double hours) {
  const BatteryStep at_once = battery_step(battery, soc_frac, wanted_power_w, hours);
  if (!battery.response.exists()) return {at_once, {}};
  const ResponsePower followed =
      response_power(battery.response, power, at_once.power_w, hours * 3'600);
  const BatteryStep step = battery_step(battery, soc_frac, followed.mean_w, hours);
  if (step.power_w == followed.mean_w) return {step, followed.end};
  const bool is_at_bound =
      step.soc_frac == battery.soc_max_frac || step.soc_frac == battery.soc_min_frac;
  return {step, is_at_bound ? PowerState{} : PowerState{step.power_w, step.power_w}};
}

// Exchange cost: the only place where energy becomes money, for accounting, planning, learning and
// settlement.

/// Cost of exchanging `energy_mwh` (grid side, charge positive) at this price, with trading costs
/// and wear. Negative: revenue.
inline double exchange_cost_eur(const BatteryParameters& battery, double energy_mwh,
                                double price_eur_per_mwh) {
  const double paid_eur_per_mwh = energy_mwh > 0
                                      ? battery.costs.import_eur_per_mwh(price_eur_per_mwh)
                                      : battery.costs.export_eur_per_mwh(price_eur_per_mwh);
  return energy_mwh * paid_eur_per_mwh + std::fabs(energy_mwh) * battery.wear_eur_per_mwh;
}

/// Profit of a step of `hours`, including own consumption.
inline double step_profit_eur(const BatteryParameters& battery, double energy_mwh, double hours,
                              double price_eur_per_mwh) {
  const double standby_mwh = battery.standby_w / kWattsPerMegawatt * hours;
  return -exchange_cost_eur(battery, energy_mwh, price_eur_per_mwh) -
         standby_mwh * battery.costs.import_eur_per_mwh(price_eur_per_mwh);
}

}  // namespace bess
