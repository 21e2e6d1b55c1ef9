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
    {BatteryFault::kSilence, "silence", "no answer", kAny},
    {BatteryFault::kLate, "late", "the answer comes --late-ms later", kAny},
    {BatteryFault::kException, "exception", "exception --exception-code", kAny},
    {BatteryFault::kDrop, "drop", "closes the connection instead of answering", kAny, true, false},
    {BatteryFault::kReset, "reset", "resets the connection (RST)", kAny, true, false},
    {BatteryFault::kHalfOpen, "half-open", "never answers on this connection again", kAny, true,
     false},
    {BatteryFault::kRefuse, "refuse", "closes a new connection immediately", kConnect, true, false},
    {BatteryFault::kTruncated, "truncated", "only the first half of the answer", kAny},
    {BatteryFault::kDrip, "drip", "the answer byte by byte, --drip-ms apart", kAny},
    {BatteryFault::kByteGap, "byte-gap", "pauses --late-ms within the answer", kAny},
    {BatteryFault::kGarbage, "garbage", "random bytes instead of the answer", kAny},
    {BatteryFault::kDuplicate, "duplicate", "TCP: the answer twice", kAny, true, false},
    {BatteryFault::kWrongTransaction, "wrong-transaction", "TCP: another transaction id", kAny,
     true, false},
    {BatteryFault::kWrongProtocol, "wrong-protocol", "TCP: protocol id 1", kAny, true, false},
    {BatteryFault::kWrongUnit, "wrong-unit", "another unit id", kAny},
    {BatteryFault::kWrongFunction, "wrong-function", "another function code", kAny},
    {BatteryFault::kWrongAddress, "wrong-address", "the echo of a write has another address",
     kWrite},
    {BatteryFault::kWrongValue, "wrong-value", "the echo of a write has another value or count",
     kWrite},
    {BatteryFault::kFewerRegisters, "fewer-registers", "one register fewer than requested", kRead},
    {BatteryFault::kBadCrc, "bad-crc", "RTU: a wrong checksum", kAny, false, true},
    {BatteryFault::kAckWithoutEffect, "ack-without-effect", "acknowledges a write without effect",
     kWrite},
    {BatteryFault::kFrozen, "frozen", "answers with the values of the last good answer", kRead},
    {BatteryFault::kWrongSign, "wrong-sign", "battery_power with the other sign", kRead},
    {BatteryFault::kSocJump, "soc-jump", "the state of charge is off by half the scale", kRead},
    {BatteryFault::kEarlyExpiry, "early-expiry", "the order in force ends immediately", kRead},
    {BatteryFault::kThrottle, "throttle", "lasts: a quarter of the power within 5 % of a limit",
     kLasting},
    {BatteryFault::kPartPower, "part-power", "lasts: 0.3 of the ordered power flows", kLasting},
    {BatteryFault::kExcessPower, "excess-power", "lasts: twice the ordered power flows", kLasting},
    {BatteryFault::kIdleDischarge, "idle-discharge",
     "lasts: while 0 W is ordered, three quarters of the rating are discharged", kLasting},
    {BatteryFault::kSlowAndNoisy, "slow-and-noisy",
     "lasts: normal behaviour: power shows orders 5 s later, with 2 % noise", kLasting},
    {BatteryFault::kSocStuck, "soc-stuck", "lasts: shows an unchanged state of charge", kLasting},
    {BatteryFault::kOtherCapacity, "other-capacity", "lasts: shows 5 times its capacity", kLasting},
    {BatteryFault::kOtherMaster, "other-master",
     "lasts: every --fault-period-s another controller orders the rated discharge", kLasting},
    {BatteryFault::kInverted, "inverted", "lasts: power flows opposite to the order", kLasting},
    {BatteryFault::kEcho, "echo", "lasts: shows the order as its power, and nothing flows",
     kLasting},
    {BatteryFault::kHalfFlow, "half-flow",
     "lasts: shows the order as its power, and half of it flows", kLasting},
    {BatteryFault::kHiddenDrain, "hidden-drain",
     "lasts: a quarter of the rating drains unmetered from the cells", kLasting},
    {BatteryFault::kSocInverted, "soc-inverted", "lasts: the state of charge falls while charging",
     kLasting},
    {BatteryFault::kSocRecalibrates, "soc-recalibrates",
     "lasts: normal behaviour: the state of charge jumps 6 % up once", kLasting},
    {BatteryFault::kForcedCharge, "forced-charge",
     "lasts: normal behaviour: below 10 % it charges itself to 11 %, whatever the order", kLasting},
    {BatteryFault::kBalancing, "balancing",
     "lasts: normal behaviour: while full, 450 W flow, whatever the order", kLasting},
    {BatteryFault::kSlowRamp, "slow-ramp", "lasts: normal behaviour: power changes by 30 W/s",
     kLasting},
    {BatteryFault::kMasterStops, "master-stops",
     "lasts: every --fault-period-s another controller releases the battery", kLasting},
    {BatteryFault::kMasterMode, "master-mode",
     "lasts: every --fault-period-s another controller changes the mode", kLasting},
    {BatteryFault::kEndsOrders, "ends-orders",
     "lasts: every --fault-period-s the device ends the order by itself", kLasting},
    {BatteryFault::kAlarm, "alarm", "lasts: shows the first alarm of its map", kLasting},
    {BatteryFault::kOffGrid, "off-grid", "lasts: reports off-grid operation", kLasting},
    {BatteryFault::kHot, "hot", "lasts: shows 70 degC", kLasting},
    {BatteryFault::kGridScaled, "grid-scaled", "lasts: shows a tenth of the grid power", kLasting},
    {BatteryFault::kGridRatio, "grid-ratio", "lasts: shows 65 % of the grid power", kLasting},
    {BatteryFault::kGridOffset, "grid-offset", "lasts: shows 1000 W less than the grid power",
     kLasting},
    {BatteryFault::kGridLate, "grid-late", "lasts: shows the grid power of one minute before",
     kLasting},
    {BatteryFault::kGridOtherPhase, "grid-other-phase",
     "lasts: shows a third of the house load, without the battery, as grid power", kLasting},
};

}  // namespace

std::span<const BatteryFaultInfo> battery_faults() { return kFaults; }

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
  return std::any_of(parts_.begin(), parts_.end(), [&](const Part& part) {
    return part.is_in_span(at_s) &&
           std::any_of(part.possible.begin(), part.possible.end(),
                       [&](const auto& info) { return info.fault == fault; });
  });
}

bool FaultPlan::Part::acts() const {
  return std::any_of(possible.begin(), possible.end(),
                     [](const auto& info) { return is_by_period(info.fault); });
}

bool FaultPlan::acts() const {
  return std::any_of(parts_.begin(), parts_.end(), [](const Part& part) { return part.acts(); });
}

std::int32_t FaultPlan::period_s() const {
  const auto found =
      std::find_if(parts_.begin(), parts_.end(), [](const Part& part) { return part.acts(); });
  return found == parts_.end() ? parts_.front().schedule.period_s : found->schedule.period_s;
}

}  // namespace bess
