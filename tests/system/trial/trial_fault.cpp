#include "tests/system/trial/trial_fault.h"

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

/// The exact order, as an echo shows it.
void show_order(Truth t, Shown& m) { m.power_w = rounded(t.ordered_w); }

void show_soc(Truth t, Shown& m, double gain) {
  m.soc_e4 = soc_e4_of(t.at_fault.soc_e4 / 1e4 + gain * t.charged_frac);
}

void freeze_soc(Truth t, Shown& m) { m.soc_e4 = t.at_fault.soc_e4; }

/// Some watts of a house, different every minute.
double house_w(std::int64_t now_s) {
  return 300 + 200.0 * static_cast<double>(now_s / 60 * 7'919 % 11);
}

/// Uniform between -1 and 1, different every half minute.
double any_share(std::int64_t now_s) {
  return static_cast<double>(now_s / 30 * 104'729 % 2'001) / 1'000 - 1;
}

constexpr TrialFault kFaults[] = {
    // Wrong power, and shown.
    {"inverted", [](Flow f) { return -f.honest_w; }},
    {"inverted_discharge", [](Flow f) { return std::abs(f.honest_w); }},
    {"inverted_charge", [](Flow f) { return -std::abs(f.honest_w); }},
    {"only_discharges", [](Flow f) { return std::min(f.honest_w, 0.0); }},
    {"only_charges", [](Flow f) { return std::max(f.honest_w, 0.0); }},
    {"twice", [](Flow f) { return 2 * f.honest_w; }},
    {"half_again", [](Flow f) { return 1.5 * f.honest_w; }},
    {"excess_2_kw",
     [](Flow f) { return f.honest_w == 0 ? 0 : f.honest_w + std::copysign(2'000, f.honest_w); }},
    {"half", [](Flow f) { return 0.5 * f.honest_w; }},
    {"third", [](Flow f) { return 0.3 * f.honest_w; }},
    {"saturates_1_kw", [](Flow f) { return std::clamp(f.honest_w, -1'000.0, 1'000.0); }},
    {"dead", [](Flow) { return 0.0; }},
    {"own_mode", [](Flow f) { return -house_w(f.now_s); }},
    {"stuck", [](Flow f) { return f.ordered_at_fault_w; }},
    {"one_order_late", [](Flow f) { return f.ordered_before_w; }},
    {"starts_after_90_s", [](Flow f) { return f.order_age_s < 90 ? 0.0 : f.honest_w; }},
    {"ends_after_30_s", [](Flow f) { return f.now_s % 120 >= 30 ? 0.0 : f.honest_w; }},
    {"ignores_zero", [](Flow f) { return f.ordered_w == 0 ? f.ordered_before_w : f.honest_w; }},
    {"idle_discharge_3_kw", [](Flow f) { return f.ordered_w == 0 ? -3'000.0 : f.honest_w; }},
    {"idle_charge_3_kw", [](Flow f) { return f.ordered_w == 0 ? 3'000.0 : f.honest_w; }},
    {"idle_drain_390_w", [](Flow f) { return f.ordered_w == 0 ? -390.0 : f.honest_w; }},
    {"erratic", [](Flow f) { return any_share(f.now_s) * f.rated_w; }},
    {"oscillates",
     [](Flow f) { return f.honest_w + (f.now_s / 30 % 2 == 0 ? 3'000.0 : -3'000.0); }},

    // Wrong power, and not shown.
    {"echo_dead", [](Flow) { return 0.0; }, show_order},
    {"echo_half", [](Flow f) { return 0.5 * f.honest_w; }, show_order},
    {"echo_fifth", [](Flow f) { return 0.2 * f.honest_w; }, show_order},
    {"echo_inverted", [](Flow f) { return -f.honest_w; }, show_order},
    {"echo_twice", [](Flow f) { return 2 * f.honest_w; }, show_order},
    {"half_hidden", [](Flow f) { return 0.5 * f.honest_w; },
     [](Truth t, Shown& m) { m.power_w = rounded(t.honest_w); }},
    {"hidden_drain_1_kw", [](Flow f) { return f.honest_w - 1'000; },
     [](Truth t, Shown& m) { m.power_w = rounded(t.honest_w); }},
    {"hidden_drain_390_w", [](Flow f) { return f.honest_w - 390; },
     [](Truth t, Shown& m) { m.power_w = rounded(t.honest_w); }},
    {"drain_390_w_shown", [](Flow f) { return f.honest_w - 390; }},
    {"idle_drain_3_kw_hidden", [](Flow f) { return f.ordered_w == 0 ? -3'000.0 : f.honest_w; },
     [](Truth t, Shown& m) {
       if (t.ordered_w == 0) m.power_w = 0;
     }},
    {"idle_drain_1_kw_hidden", [](Flow f) { return f.ordered_w == 0 ? -1'000.0 : f.honest_w; },
     [](Truth t, Shown& m) {
       if (t.ordered_w == 0) m.power_w = 0;
     }},

    // Correct power, wrong display.
    {"soc_frozen", nullptr, freeze_soc},
    {"power_frozen", nullptr, [](Truth t, Shown& m) { m.power_w = t.at_fault.power_w; }},
    {"all_frozen", nullptr, [](Truth t, Shown& m) { m = t.at_fault; }},
    {"all_frozen_but_echo", nullptr,
     [](Truth t, Shown& m) {
       freeze_soc(t, m);
       show_order(t, m);
     }},
    {"soc_inverted", nullptr, [](Truth t, Shown& m) { show_soc(t, m, -1); }},
    {"soc_five_times", nullptr, [](Truth t, Shown& m) { show_soc(t, m, 5); }},
    {"soc_a_fifth", nullptr, [](Truth t, Shown& m) { show_soc(t, m, 0.2); }},
    {"soc_half", nullptr, [](Truth t, Shown& m) { show_soc(t, m, 0.5); }},
    {"soc_in_tens", nullptr, [](Truth, Shown& m) { m.soc_e4 = m.soc_e4 / 1'000 * 1'000; }},
    {"soc_at_least_9_percent", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = std::max(m.soc_e4, 900); }},
    {"soc_at_least_40_percent", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = std::max(m.soc_e4, 4'000); }},
    {"soc_at_most_50_percent", nullptr,
     [](Truth, Shown& m) { m.soc_e4 = std::min(m.soc_e4, 5'000); }},
    {"soc_creeps_up", nullptr,
     [](Truth t, Shown& m) {
       m.soc_e4 = std::min(m.soc_e4 + static_cast<std::int32_t>(t.fault_s / 120) * 100, 10'000);
     }},
    {"soc_erratic", nullptr,
     [](Truth t, Shown& m) { m.soc_e4 = soc_e4_of(m.soc_e4 / 1e4 + 0.2 * any_share(t.fault_s)); }},
    {"power_inverted", nullptr, [](Truth t, Shown& m) { m.power_w = rounded(-t.flow_w); }},
    {"power_in_kilowatts", nullptr,
     [](Truth t, Shown& m) { m.power_w = rounded(t.flow_w / 1'000); }},
    {"power_ten_times", nullptr, [](Truth t, Shown& m) { m.power_w = rounded(t.flow_w * 10); }},
    {"limit_0_w_shown", [](Flow) { return 0.0; },
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
