// What the simulated battery can do wrong, and when: the faults by name, each with what it does,
// and a schedule that draws them (every Nth chance, or with a probability from a seed, within a
// span of simulated time). How a fault looks on the bus: bus_reply; what it does to values:
// battery_server.
#pragma once

#include <cstdint>
#include <limits>
#include <random>
#include <span>
#include <vector>

namespace bess {

enum class BatteryFault : std::uint8_t {
  kNone,
  kSilence,
  kLate,
  kException,
  kDrop,
  kReset,
  kHalfOpen,
  kRefuse,
  kTruncated,
  kDrip,
  kByteGap,
  kGarbage,
  kDuplicate,
  kWrongTransaction,
  kWrongProtocol,
  kWrongUnit,
  kWrongFunction,
  kWrongAddress,
  kWrongValue,
  kFewerRegisters,
  kBadCrc,
  kAckWithoutEffect,
  kFrozen,
  kWrongSign,
  kSocJump,
  kEarlyExpiry,
  kThrottle,
  kPartPower,
  kExcessPower,
  kIdleDischarge,
  kSlowAndNoisy,
  kSocStuck,
  kOtherCapacity,
  kOtherMaster,
  kInverted,
  kEcho,
  kHalfFlow,
  kHiddenDrain,
  kSocInverted,
  kSocRecalibrates,
  kForcedCharge,
  kBalancing,
  kSlowRamp,
  kMasterStops,
  kMasterMode,
  kEndsOrders,
  kAlarm,
  kOffGrid,
  kHot,
  kGridScaled,
  kGridRatio,
  kGridOffset,
  kGridLate,
  kGridOtherPhase,
};

/// A moment at which a fault may strike.
enum class FaultChance : std::uint8_t { kConnect = 1, kRead = 2, kWrite = 4 };

struct BatteryFaultInfo {
  BatteryFault fault;
  const char* name;
  const char* text;
  unsigned chances;  ///< FaultChance bits
  bool tcp = true;
  bool rtu = true;
};

/// Of what a device shows of the grid's power: a meter, or a battery's own grid point.
constexpr bool is_of_grid(BatteryFault fault) { return fault >= BatteryFault::kGridScaled; }

/// Of what acts by itself, every `period_s`, on the order in force.
constexpr bool is_by_period(BatteryFault fault) {
  using enum BatteryFault;
  return fault == kOtherMaster || fault == kMasterStops || fault == kMasterMode ||
         fault == kEndsOrders;
}

/// Every fault but kNone, in the order of the enumeration.
std::span<const BatteryFaultInfo> battery_faults();

struct FaultSchedule {
  std::vector<BatteryFault> faults;  ///< one of them at each strike
  std::int32_t every = 10;           ///< at every Nth chance
  double probability = 0;            ///< above 0: at each chance with this, instead of `every`
  std::uint64_t seed = 1;
  double from_s = 0;  ///< simulated seconds since the simulator's start
  double to_s = std::numeric_limits<double>::infinity();
  /// Within its span it comes and goes: so long it may strike, then so long not. 0 = it stays.
  double on_s = 0;
  double off_s = 0;
  std::int32_t period_s = 30;  ///< at which somebody, or the device, ends or replaces the order
};

/// Several schedules, each with its own chances and its own seed; where two strike at once, the
/// first.
class FaultPlan {
 public:
  FaultPlan(const std::vector<FaultSchedule>& schedules, bool rtu);
  FaultPlan(const FaultSchedule& schedule, bool rtu) : FaultPlan(std::vector{schedule}, rtu) {}

  /// The fault that strikes now, or kNone. `at_s` counts from the start.
  BatteryFault draw(FaultChance chance, double at_s);
  /// A fault that lasts is in force.
  [[nodiscard]] bool lasts(BatteryFault fault, double at_s) const;
  /// One of those that act by themselves, every `period_s`.
  [[nodiscard]] bool acts() const;
  [[nodiscard]] std::int32_t period_s() const;
  /// Which schedule the last fault was of.
  [[nodiscard]] std::size_t struck() const { return struck_; }
  std::mt19937_64& random() { return parts_[struck_].random; }

 private:
  struct Part {
    FaultSchedule schedule;
    std::vector<BatteryFaultInfo> possible;
    std::mt19937_64 random;
    std::int64_t chances = 0;

    [[nodiscard]] bool is_in_span(double at_s) const;
    [[nodiscard]] bool acts() const;
    BatteryFault draw(FaultChance chance, double at_s);
  };

  std::vector<Part> parts_;  ///< one at least
  std::size_t struck_ = 0;
};

}  // namespace bess
