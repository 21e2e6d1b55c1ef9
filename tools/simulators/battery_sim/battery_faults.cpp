#include "tools/simulators/battery_sim/battery_faults.h"

#include <algorithm>
#include <cmath>

namespace bess {
namespace {

constexpr unsigned kConnect = static_cast<unsigned>(FaultChance::kConnect);
constexpr unsigned kRead = static_cast<unsigned>(FaultChance::kRead);
constexpr unsigned kWrite = static_cast<unsigned>(FaultChance::kWrite);
constexpr unsigned kAny = kRead | kWrite;
/// Not tied to a request: active from --fault-from-s to --fault-to-s.
constexpr unsigned kLasting = 0;

constexpr BatteryFaultInfo kFaults[] = {
#define BESS_ROW(fault, ...) {BatteryFault::fault, __VA_ARGS__},
    BESS_BATTERY_FAULTS(BESS_ROW)
#undef BESS_ROW
};

}  // namespace

std::span<const BatteryFaultInfo> battery_faults() { return kFaults; }

const BatteryFaultInfo* find_fault(std::string_view name) {
  for (const BatteryFaultInfo& fault : kFaults) {
    if (name == fault.name) return &fault;
  }
  return nullptr;
}

const char* battery_fault_name(BatteryFault fault) {
  return kFaults[static_cast<std::size_t>(fault) - 1].name;
}

FaultPlan::FaultPlan(const std::vector<FaultSchedule>& schedules, bool rtu) {
  for (const FaultSchedule& schedule : schedules) {
    Part& part = parts_.emplace_back(
        Part{.schedule = schedule, .possible = {}, .random = std::mt19937_64(schedule.seed)});
    for (const BatteryFault fault : schedule.faults) {
      for (const BatteryFaultInfo& info : kFaults) {
        if (info.fault == fault && (rtu ? info.rtu : info.tcp)) part.possible.push_back(info);
      }
    }
  }
  if (parts_.empty()) parts_.emplace_back();
}

bool FaultPlan::Part::is_in_span(double at_s) const {
  if (at_s < schedule.from_s || at_s >= schedule.to_s) return false;
  const double period_s = schedule.on_s + schedule.off_s;
  return schedule.off_s == 0 || std::fmod(at_s - schedule.from_s, period_s) < schedule.on_s;
}

BatteryFault FaultPlan::Part::draw(FaultChance chance, double at_s) {
  std::vector<BatteryFault> now;
  for (const BatteryFaultInfo& info : possible) {
    if ((info.chances & static_cast<unsigned>(chance)) != 0) now.push_back(info.fault);
  }
  if (now.empty() || !is_in_span(at_s)) return BatteryFault::kNone;
  const bool strikes = schedule.probability > 0
                           ? std::uniform_real_distribution<>(0, 1)(random) < schedule.probability
                           : ++chances % schedule.every == 0;
  if (!strikes) return BatteryFault::kNone;
  return now[std::uniform_int_distribution<std::size_t>(0, now.size() - 1)(random)];
}

BatteryFault FaultPlan::draw(FaultChance chance, double at_s) {
  BatteryFault first = BatteryFault::kNone;
  for (std::size_t i = 0; i < parts_.size(); ++i) {
    const BatteryFault fault = parts_[i].draw(chance, at_s);
    if (fault == BatteryFault::kNone || first != BatteryFault::kNone) continue;
    first = fault;
    struck_ = i;
  }
  return first;
}

bool FaultPlan::lasts(BatteryFault fault, double at_s) const {
  return std::ranges::any_of(parts_, [&](const Part& part) {
    return part.is_in_span(at_s) &&
           std::ranges::find(part.possible, fault, &BatteryFaultInfo::fault) != part.possible.end();
  });
}

std::int32_t FaultPlan::period_s() const {
  for (const Part& part : parts_) {
    const bool acts = std::ranges::any_of(part.possible, is_by_period, &BatteryFaultInfo::fault);
    if (acts) return part.schedule.period_s;
  }
  return 0;
}

}  // namespace bess
