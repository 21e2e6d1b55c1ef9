#include <algorithm>
#include <cmath>

#include "tools/hil_runner/judge/judge_context.h"

namespace bess {
namespace {

constexpr double kSocTolerance = 0.00006;  ///< resolution of the edge
constexpr double kWatts = 2;               ///< rounding of an order on three phases

std::string text_of(const std::optional<double>& value) {
  return value ? fmt::format("{:g}", *value) : "nothing";
}

bool is_near(const std::optional<double>& value, double other, double tolerance) {
  return value && std::abs(*value - other) <= tolerance;
}

/// Values on the wire at an instant.
WireReading reading_at(const std::vector<WireReading>& wire, std::int64_t utc_ns) {
  const auto next = std::ranges::upper_bound(wire, utc_ns, {}, &WireReading::utc_ns);
  return next == wire.begin() ? WireReading{} : *(next - 1);
}

/// The values in the log must have been on the wire in the control cycle.
void judge_reading(JudgeContext& judging, const CycleRecord& cycle, std::int64_t tick_ns) {
  const std::int64_t by_ns = judging.settled_ns(tick_ns);
  constexpr std::int64_t kReadBeforeNs =
      30 * kSecondNs;  // by the previous control cycle, or in between
  const std::int64_t from_ns = tick_ns - kReadBeforeNs;
  const WireReading before = reading_at(judging.evidence.wire, from_ns);
  bool has_soc = false;
  bool has_power = false;
  const auto look = [&](const WireReading& reading) {
    has_soc |= is_near(reading.soc_frac, 1e-4 * cycle.measurement.soc_e4, kSocTolerance);
    has_power |= is_near(reading.power_w, cycle.measurement.power_w, kWatts);
  };
  look(before);
  for (const WireReading& reading : judging.evidence.wire) {
    if (reading.utc_ns > from_ns && reading.utc_ns <= by_ns) look(reading);
  }
  const WireReading after = reading_at(judging.evidence.wire, by_ns);
  if (!has_soc) {
    judging.find(by_ns, fmt::format("a SoC of {} on the wire", text_of(after.soc_frac)),
                 fmt::format("{:.4f}", 1e-4 * cycle.measurement.soc_e4));
  }
  if (!has_power) {
    judging.find(by_ns, fmt::format("{} W on the wire", text_of(after.power_w)),
                 fmt::format("{} W", cycle.measurement.power_w));
  }
}

/// Compares values on the wire with the battery trace.
void judge_truth(JudgeContext& judging, std::int64_t utc_ns) {
  constexpr double kWholePercent = 0.0101;  // resolution of some devices
  const WireReading reading = reading_at(judging.evidence.wire, utc_ns);
  const double soc_frac = judging.soc_at(utc_ns);
  const double rated_w = judging.scenario.battery.physics.power_w_max;
  const double flow_frac = rated_w / 30 / judging.scenario.battery.physics.capacity_wh;
  if (!is_near(reading.soc_frac, soc_frac, kWholePercent + flow_frac)) {
    judging.find(utc_ns, fmt::format("a SoC near {:.4f} on the wire", soc_frac),
                 text_of(reading.soc_frac));
  }
  const CommandInForce command = judging.command_at(utc_ns);
  const double tolerance_w = kWatts + 0.001 * rated_w;
  if (command.is_driven && !is_near(reading.ordered_w, command.power_w, tolerance_w)) {
    judging.find(utc_ns, fmt::format("{:.0f} W ordered on the wire", command.power_w),
                 text_of(reading.ordered_w));
  }
}

}  // namespace

void judge_witness(JudgeContext& judging) {
  if (!judging.scenario.witness || judging.evidence.wire.empty()) return;
  const double tolerance_w = kWatts + 0.001 * judging.scenario.battery.physics.power_w_max;
  for (const CycleRecord& cycle : judging.evidence.log) {
    const std::int64_t tick_ns = cycle.utc_s * kSecondNs;
    const std::int64_t by_ns = judging.settled_ns(tick_ns);
    if (cycle.mode != Mode::kRunning || !cycle.has_measurement || judging.is_disturbed(tick_ns) ||
        by_ns >= judging.scenario.end_utc_ns()) {
      continue;
    }
    judge_reading(judging, cycle, tick_ns);
    judge_truth(judging, by_ns);
    const WireReading reading = reading_at(judging.evidence.wire, by_ns);
    if (cycle.written && !is_near(reading.ordered_w, cycle.ordered_power_w, tolerance_w)) {
      judging.find(by_ns, fmt::format("{} W ordered on the wire, as logged", cycle.ordered_power_w),
                   text_of(reading.ordered_w));
    }
  }
}

}  // namespace bess
