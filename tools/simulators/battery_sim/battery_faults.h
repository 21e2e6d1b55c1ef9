// Faults of the simulated battery, by name, and their schedule: at every Nth opportunity or with a
// probability from a seed, within a span of simulated time. Effect on the bus: bus_reply; on
// values: faulty_device.
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

struct FaultSchedule {
  std::vector<BatteryFault> faults;  ///< one of them at a time
  std::int32_t every = 10;           ///< at every Nth opportunity
  double probability = 0;            ///< above 0: per opportunity, instead of `every`
  std::uint64_t seed = 1;
  double from_s = 0;  ///< simulated seconds since the simulator's start
  double to_s = std::numeric_limits<double>::infinity();
  /// Intermittent within its span: on-time and off-time. 0: permanent.
  double on_s = 0;
  double off_s = 0;
  std::int32_t period_s = 30;  ///< between ends or replacements of the order
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
  /// Whether a fault acts by itself, every `period_s`.
  [[nodiscard]] bool acts() const;
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
    [[nodiscard]] bool acts() const;
    BatteryFault draw(FaultChance chance, double at_s);
  };

  std::vector<Part> parts_;  ///< at least one
  std::size_t struck_ = 0;
};

}  // namespace bess
