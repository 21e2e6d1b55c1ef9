#include "tests/trial/trial_fault.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace bess::trial {
namespace {

using Flow = const FlowView&;
using Truth = const ShownView&;
using Shown = BatteryMeasurement;

std::int32_t rounded(double value) { return static_cast<std::int32_t>(std::lround(value)); }

std::int32_t soc_e4_of(double frac) { return rounded(std::clamp(frac, 0.0, 1.0) * 1e3) * 10; }

/// The order to the digit, as an echo shows it.
void show_order(Truth t, Shown& m) { m.power_w = rounded(t.ordered_w); }

void show_soc(Truth t, Shown& m, double gain) {
  m.soc_e4 = soc_e4_of(t.at_fault.soc_e4 / 1e4 + gain * t.charged_frac);
}

void freeze_soc(Truth t, Shown& m) { m.soc_e4 = t.at_fault.soc_e4; }

/// Some watts of any house, another every minute.
double house_w(std::int64_t now_s) {
  return 300 + 200.0 * static_cast<double>(now_s / 60 * 7'919 % 11);
}

/// Evenly between -1 and 1, another every half minute.
double any_share(std::int64_t now_s) {
  return static_cast<double>(now_s / 30 * 104'729 % 2'001) / 1'000 - 1;
}

constexpr TrialFault kFaults[] = {
    // What flows is wrong, and is shown.
    {"inverted", "the other way", [](Flow f) { return -f.honest_w; }},
    {"inverted_discharge", "charges when told to discharge",
     [](Flow f) { return std::abs(f.honest_w); }},
    {"inverted_charge", "discharges when told to charge",
     [](Flow f) { return -std::abs(f.honest_w); }},
    {"only_discharges", "no power when told to charge",
     [](Flow f) { return std::min(f.honest_w, 0.0); }},
    {"only_charges", "no power when told to discharge",
     [](Flow f) { return std::max(f.honest_w, 0.0); }},
    {"twice", "twice the order", [](Flow f) { return 2 * f.honest_w; }},
    {"half_again", "1.5 times the order", [](Flow f) { return 1.5 * f.honest_w; }},
    {"excess_2_kw", "2 kW more than ordered",
     [](Flow f) { return f.honest_w == 0 ? 0 : f.honest_w + std::copysign(2'000, f.honest_w); }},
    {"half", "half the order", [](Flow f) { return 0.5 * f.honest_w; }},
    {"third", "0.3 of the order", [](Flow f) { return 0.3 * f.honest_w; }},
    {"saturates_1_kw", "at most 1 kW",
     [](Flow f) { return std::clamp(f.honest_w, -1'000.0, 1'000.0); }},
    {"dead", "no power", [](Flow) { return 0.0; }},
    {"own_mode", "covers a house, whatever is ordered; acknowledges all",
     [](Flow f) { return -house_w(f.now_s); }},
    {"stuck", "goes on with the order at which it broke",
     [](Flow f) { return f.ordered_at_fault_w; }},
    {"one_order_late", "follows the order before this one",
     [](Flow f) { return f.ordered_before_w; }},
    {"starts_after_90_s", "no power in the first 90 s of an order",
     [](Flow f) { return f.order_age_s < 90 ? 0.0 : f.honest_w; }},
    {"ends_after_30_s", "no power after 30 s of a cycle, its registers stay",
     [](Flow f) { return f.now_s % 120 >= 30 ? 0.0 : f.honest_w; }},
    {"ignores_zero", "goes on with the order before when 0 W is ordered",
     [](Flow f) { return f.ordered_w == 0 ? f.ordered_before_w : f.honest_w; }},
    {"idle_discharge_3_kw", "3 kW out at 0 W",
     [](Flow f) { return f.ordered_w == 0 ? -3'000.0 : f.honest_w; }},
    {"idle_charge_3_kw", "3 kW in at 0 W",
     [](Flow f) { return f.ordered_w == 0 ? 3'000.0 : f.honest_w; }},
    {"idle_drain_390_w", "390 W out at 0 W, shown",
     [](Flow f) { return f.ordered_w == 0 ? -390.0 : f.honest_w; }},
    {"erratic", "any power, another every half minute",
     [](Flow f) { return any_share(f.now_s) * f.rated_w; }},
    {"oscillates", "the order with 3 kW up and down on it, half a minute each",
     [](Flow f) { return f.honest_w + (f.now_s / 30 % 2 == 0 ? 3'000.0 : -3'000.0); }},

    // What flows is wrong, and is not shown.
    {"echo_dead", "shows the order to the digit, nothing flows", [](Flow) { return 0.0; },
     show_order},
    {"echo_half", "shows the order to the digit, half flows",
     [](Flow f) { return 0.5 * f.honest_w; }, show_order},
    {"echo_fifth", "shows the order to the digit, a fifth flows",
     [](Flow f) { return 0.2 * f.honest_w; }, show_order},
    {"echo_inverted", "shows the order to the digit, flows the other way",
     [](Flow f) { return -f.honest_w; }, show_order},
    {"echo_twice", "shows the order to the digit, twice as much flows",
     [](Flow f) { return 2 * f.honest_w; }, show_order},
    {"half_hidden", "shows what was ordered, with its noise; half flows",
     [](Flow f) { return 0.5 * f.honest_w; },
     [](Truth t, Shown& m) { m.power_w = rounded(t.honest_w); }},
    {"hidden_drain_1_kw", "1 kW out besides, never shown",
     [](Flow f) { return f.honest_w - 1'000; },
     [](Truth t, Shown& m) { m.power_w = rounded(t.honest_w); }},
    {"hidden_drain_390_w", "390 W out besides, never shown",
     [](Flow f) { return f.honest_w - 390; },
     [](Truth t, Shown& m) { m.power_w = rounded(t.honest_w); }},
    {"drain_390_w_shown", "390 W out besides, shown", [](Flow f) { return f.honest_w - 390; }},
    {"idle_drain_3_kw_hidden", "3 kW out at 0 W, 0 W shown",
     [](Flow f) { return f.ordered_w == 0 ? -3'000.0 : f.honest_w; },
     [](Truth t, Shown& m) {
       if (t.ordered_w == 0) m.power_w = 0;
     }},
    {"idle_drain_1_kw_hidden", "1 kW out at 0 W, 0 W shown",
     [](Flow f) { return f.ordered_w == 0 ? -1'000.0 : f.honest_w; },
     [](Truth t, Shown& m) {
       if (t.ordered_w == 0) m.power_w = 0;
     }},

    // What flows is right, what is shown is not.
    {"soc_frozen", "its SoC stands still", nullptr, freeze_soc},
    {"power_frozen", "its power stands still", nullptr,
     [](Truth t, Shown& m) { m.power_w = t.at_fault.power_w; }},
    {"all_frozen", "all that it measures stands still", nullptr,
     [](Truth t, Shown& m) { m = t.at_fault; }},
    {"all_frozen_but_echo", "its SoC stands still, its power is the order to the digit", nullptr,
     [](Truth t, Shown& m) {
       freeze_soc(t, m);
       show_order(t, m);
     }},
    {"soc_inverted", "its SoC falls when it is charged", nullptr,
     [](Truth t, Shown& m) { show_soc(t, m, -1); }},
    {"soc_five_times", "its SoC moves five times too fast", nullptr,
     [](Truth t, Shown& m) { show_soc(t, m, 5); }},
    {"soc_a_fifth", "its SoC moves five times too slowly", nullptr,
     [](Truth t, Shown& m) { show_soc(t, m, 0.2); }},
    {"soc_half", "its SoC moves at half its speed", nullptr,
     [](Truth t, Shown& m) { show_soc(t, m, 0.5); }},
    {"soc_in_tens", "its SoC in whole tens of percent, cut off", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = m.soc_e4 / 1'000 * 1'000; }},
    {"soc_at_least_9_percent", "its SoC is never shown below 9 %", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = std::max(m.soc_e4, 900); }},
    {"soc_at_least_40_percent", "its SoC is never shown below 40 %", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = std::max(m.soc_e4, 4'000); }},
    {"soc_at_most_50_percent", "its SoC is never shown above 50 %", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = std::min(m.soc_e4, 5'000); }},
    {"soc_creeps_up", "its SoC gains 1 % a cycle", nullptr,
     [](Truth t, Shown& m) {
       m.soc_e4 = std::min(m.soc_e4 + static_cast<std::int32_t>(t.fault_s / 120) * 100, 10'000);
     }},
    {"soc_erratic", "its SoC is off by up to 20 %, another every half minute", nullptr,
     [](Truth t, Shown& m) { m.soc_e4 = soc_e4_of(m.soc_e4 / 1e4 + 0.2 * any_share(t.fault_s)); }},
    {"power_inverted", "its power with the other sign", nullptr,
     [](Truth t, Shown& m) { m.power_w = rounded(-t.flow_w); }},
    {"power_in_kilowatts", "its power in kilowatts", nullptr,
     [](Truth t, Shown& m) { m.power_w = rounded(t.flow_w / 1'000); }},
    {"power_ten_times", "its power in tenths of a watt", nullptr,
     [](Truth t, Shown& m) { m.power_w = rounded(t.flow_w * 10); }},
    {"limit_0_w_shown", "gives nothing, and shows that its limit is 0 W", [](Flow) { return 0.0; },
     [](Truth, Shown& m) { m.charge_w_max = m.discharge_w_max = 0; }},
};

}  // namespace

std::span<const TrialFault> trial_faults() { return kFaults; }

const TrialFault& trial_fault(std::string_view name) {
  const auto* found = std::find_if(std::begin(kFaults), std::end(kFaults),
                                   [&](const TrialFault& f) { return name == f.name; });
  if (found == std::end(kFaults)) std::abort();
  return *found;
}

}  // namespace bess::trial
