// Faults of the simulated battery, by name, and their schedule: at every Nth opportunity or with a
// probability from a seed, within a span of simulated time. Effect on the bus: bus_reply; on
// values: faulty_device.
#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <string_view>
#include <vector>

namespace bess {

/// All faults, one row each: constant, name, text for the help, opportunities, and whether it
/// exists over TCP and RTU (default: both).
#define BESS_BATTERY_FAULTS(ROW)                                                                 \
  ROW(kSilence, "silence", "no answer", kAny)                                                    \
  ROW(kLate, "late", "the answer comes --late-ms later", kAny)                                   \
  ROW(kException, "exception", "exception --exception-code", kAny)                               \
  ROW(kDrop, "drop", "closes the connection instead of answering", kAny, true, false)            \
  ROW(kReset, "reset", "resets the connection (RST)", kAny, true, false)                         \
  ROW(kHalfOpen, "half-open", "never answers on this connection again", kAny, true, false)       \
  ROW(kRefuse, "refuse", "closes a new connection immediately", kConnect, true, false)           \
  ROW(kTruncated, "truncated", "only the first half of the answer", kAny)                        \
  ROW(kDrip, "drip", "the answer byte by byte, --drip-ms apart", kAny)                           \
  ROW(kByteGap, "byte-gap", "pauses --late-ms within the answer", kAny)                          \
  ROW(kGarbage, "garbage", "random bytes instead of the answer", kAny)                           \
  ROW(kDuplicate, "duplicate", "TCP: the answer twice", kAny, true, false)                       \
  ROW(kWrongTransaction, "wrong-transaction", "TCP: another transaction id", kAny, true, false)  \
  ROW(kWrongProtocol, "wrong-protocol", "TCP: protocol id 1", kAny, true, false)                 \
  ROW(kWrongUnit, "wrong-unit", "another unit id", kAny)                                         \
  ROW(kWrongFunction, "wrong-function", "another function code", kAny)                           \
  ROW(kWrongAddress, "wrong-address", "the echo of a write has another address", kWrite)         \
  ROW(kWrongValue, "wrong-value", "the echo of a write has another value or count", kWrite)      \
  ROW(kFewerRegisters, "fewer-registers", "one register fewer than requested", kRead)            \
  ROW(kBadCrc, "bad-crc", "RTU: a wrong checksum", kAny, false, true)                            \
  ROW(kAckWithoutEffect, "ack-without-effect", "acknowledges a write without effect", kWrite)    \
  ROW(kFrozen, "frozen", "answers with the values of the last good answer", kRead)               \
  ROW(kWrongSign, "wrong-sign", "battery_power with the other sign", kRead)                      \
  ROW(kSocJump, "soc-jump", "the state of charge is off by half the scale", kRead)               \
  ROW(kEarlyExpiry, "early-expiry", "the order in force ends immediately", kRead)                \
  ROW(kThrottle, "throttle", "lasts: a quarter of the power within 5 % of a limit", kLasting)    \
  ROW(kPartPower, "part-power", "lasts: 0.3 of the ordered power flows", kLasting)               \
  ROW(kExcessPower, "excess-power", "lasts: twice the ordered power flows", kLasting)            \
  ROW(kIdleDischarge, "idle-discharge",                                                          \
      "lasts: while 0 W is ordered, three quarters of the rating are discharged", kLasting)      \
  ROW(kSlowAndNoisy, "slow-and-noisy",                                                           \
      "lasts: normal behaviour: power shows orders 5 s later, with 2 % noise", kLasting)         \
  ROW(kSocStuck, "soc-stuck", "lasts: shows an unchanged state of charge", kLasting)             \
  ROW(kOtherCapacity, "other-capacity", "lasts: shows 5 times its capacity", kLasting)           \
  ROW(kOtherMaster, "other-master",                                                              \
      "lasts: every --fault-period-s another controller orders the rated discharge", kLasting)   \
  ROW(kInverted, "inverted", "lasts: power flows opposite to the order", kLasting)               \
  ROW(kEcho, "echo", "lasts: shows the order as its power, and nothing flows", kLasting)         \
  ROW(kHalfFlow, "half-flow", "lasts: shows the order as its power, and half of it flows",       \
      kLasting)                                                                                  \
  ROW(kHiddenDrain, "hidden-drain",                                                              \
      "lasts: a quarter of the rating drains unmetered from the cells", kLasting)                \
  ROW(kSocInverted, "soc-inverted", "lasts: the state of charge falls while charging", kLasting) \
  ROW(kSocRecalibrates, "soc-recalibrates",                                                      \
      "lasts: normal behaviour: the state of charge jumps 6 % up once", kLasting)                \
  ROW(kForcedCharge, "forced-charge",                                                            \
      "lasts: normal behaviour: below 10 % it charges itself to 11 %, whatever the order",       \
      kLasting)                                                                                  \
  ROW(kBalancing, "balancing",                                                                   \
      "lasts: normal behaviour: while full, 450 W flow, whatever the order", kLasting)           \
  ROW(kSlowRamp, "slow-ramp", "lasts: normal behaviour: power changes by 30 W/s", kLasting)      \
  ROW(kMasterStops, "master-stops",                                                              \
      "lasts: every --fault-period-s another controller releases the battery", kLasting)         \
  ROW(kMasterMode, "master-mode",                                                                \
      "lasts: every --fault-period-s another controller changes the mode", kLasting)             \
  ROW(kEndsOrders, "ends-orders",                                                                \
      "lasts: every --fault-period-s the device ends the order by itself", kLasting)             \
  ROW(kAlarm, "alarm", "lasts: shows the first alarm of its map", kLasting)                      \
  ROW(kOffGrid, "off-grid", "lasts: reports off-grid operation", kLasting)                       \
  ROW(kHot, "hot", "lasts: shows 70 degC", kLasting)                                             \
  ROW(kGridScaled, "grid-scaled", "lasts: shows a tenth of the grid power", kLasting)            \
  ROW(kGridRatio, "grid-ratio", "lasts: shows 65 % of the grid power", kLasting)                 \
  ROW(kGridOffset, "grid-offset", "lasts: shows 1000 W less than the grid power", kLasting)      \
  ROW(kGridLate, "grid-late", "lasts: shows the grid power of one minute before", kLasting)      \
  ROW(kGridOtherPhase, "grid-other-phase",                                                       \
      "lasts: shows a third of the house load, without the battery, as grid power", kLasting)

enum class BatteryFault : std::uint8_t {
  kNone,
#define BESS_ROW(fault, ...) fault,
  BESS_BATTERY_FAULTS(BESS_ROW)
#undef BESS_ROW
};

/// Opportunity of a fault.
enum class FaultChance : std::uint8_t { kConnect = 1, kRead = 2, kWrite = 4 };

struct BatteryFaultInfo {
  BatteryFault fault;
  const char* name;
  const char* text;
  unsigned chances;  ///< FaultChance bits
  bool tcp = true;
  bool rtu = true;
};

/// Faults of the displayed grid power: of a meter, or of a battery's grid point.
constexpr bool is_of_grid(BatteryFault fault) { return fault >= BatteryFault::kGridScaled; }

/// Faults that act on the order in force by themselves, every `period_s`.
constexpr bool is_by_period(BatteryFault fault) {
  using enum BatteryFault;
  return fault == kOtherMaster || fault == kMasterStops || fault == kMasterMode ||
         fault == kEndsOrders;
}

/// Every fault but kNone, in the order of the enumeration.
std::span<const BatteryFaultInfo> battery_faults();

/// Null: unknown.
const BatteryFaultInfo* find_fault(std::string_view name);
/// Not for kNone.
const char* battery_fault_name(BatteryFault fault);

struct FaultSchedule {
  std::vector<BatteryFault> faults{};  ///< one of them at a time
  std::int32_t every = 10;             ///< at every Nth opportunity
  double probability = 0;              ///< above 0: per opportunity, instead of `every`
  std::uint64_t seed = 1;
  double from_s = 0;  ///< simulated seconds since the simulator's start
  double to_s = std::numeric_limits<double>::infinity();
  /// Intermittent within its span: on-time and off-time. 0: permanent.
  double on_s = 0;
  double off_s = 0;
  std::int32_t period_s = 30;  ///< between ends or replacements of the order
  std::int32_t late_ms = 1'500;
  std::int32_t drip_ms = 100;
  std::int32_t exception_code = 6;

  [[nodiscard]] bool strikes_always() const {
    return !faults.empty() && every == 1 && probability == 0 && off_s == 0;
  }
};

/// Several schedules, each with its own opportunities and seed; the first one takes precedence.
class FaultPlan {
 public:
  FaultPlan(const std::vector<FaultSchedule>& schedules, bool rtu);
  FaultPlan(const FaultSchedule& schedule, bool rtu) : FaultPlan(std::vector{schedule}, rtu) {}

  /// Fault at this opportunity, or kNone. `at_s` counts from the start.
  BatteryFault draw(FaultChance chance, double at_s);
  /// Whether a lasting fault is active.
  [[nodiscard]] bool lasts(BatteryFault fault, double at_s) const;
  /// Period of a fault that acts by itself; 0: none does.
  [[nodiscard]] std::int32_t period_s() const;
  /// Schedule of the last fault.
  [[nodiscard]] std::size_t struck() const { return struck_; }
  std::mt19937_64& random() { return parts_[struck_].random; }

 private:
  struct Part {
    FaultSchedule schedule;
    std::vector<BatteryFaultInfo> possible;
    std::mt19937_64 random;
    std::int64_t chances = 0;

    [[nodiscard]] bool is_in_span(double at_s) const;
    BatteryFault draw(FaultChance chance, double at_s);
  };

  std::vector<Part> parts_;  ///< at least one
  std::size_t struck_ = 0;
};

}  // namespace bess
