// Trial run: the control loop against the trial battery, in moved time. Orders come from prices or
// a hold, a fault begins at a tick; returns the result.
#pragma once

#include <cstdint>
#include <deque>
#include <iterator>
#include <optional>
#include <string_view>

#include "edge/app/program/restored_run.h"
#include "edge/core/loop/control_loop.h"
#include "shared/host/minute_file.h"
#include "tests/system/trial/trial_battery.h"

namespace bess::trial {

/// Orders that the prices, or a hold, cause.
enum class Orders : std::uint8_t {
  kCharge,
  kDischarge,
  kZero,
  kAlternating,
  kPairs,
  kRealDay,
  kHours
};
/// kHours, 40 minutes each way, is for faults that take days.
std::string_view orders_name(Orders orders);

struct TrialPrices {
  void request(std::int64_t minute_utc_s, std::int64_t, std::int64_t) {
    wanted_utc_s = minute_utc_s;
  }
  static bool wait(std::int64_t) { return true; }
  [[nodiscard]] PriceReport latest() const {
    return {.has_row = true,
            .minute_utc_s = wanted_utc_s,
            .price_centi_eur_per_mwh = price_centi_eur_per_mwh,
            .status = Status::kOk};
  }
  std::int64_t wanted_utc_s = 0;
  std::int32_t price_centi_eur_per_mwh = 0;
};

/// State that a run leaves for the next one.
struct TrialLog {
  static constexpr std::size_t kRecordsMax = 500;  ///< more than a start reads
  bool read_back(std::int64_t records_ago, CycleRecord& record) const {
    if (records_ago >= std::ssize(records)) return false;
    record = records[records.size() - 1 - static_cast<std::size_t>(records_ago)];
    return true;
  }
  std::deque<CycleRecord> records;
};

class TrialSite {
 public:
  using Loop = ControlLoop<TrialBattery, TrialPrices, TrialClock>;

  TrialSite(const BatteryNature& nature, double soc_frac, const ControlSettings& settings,
            std::uint64_t seed);
  TrialSite(const TrialSite&) = delete;
  TrialSite& operator=(const TrialSite&) = delete;

  /// The control cycle of the next tick, with such orders.
  CycleRecord cycle(Orders orders);
  /// With an operator's hold.
  CycleRecord cycle_held(std::int32_t power_w);
  [[nodiscard]] std::int64_t next_tick_utc_s() const;

  TrialClock clock;
  TrialBattery battery;
  TrialPrices prices;
  LatestHold holds;

  /// Killed between two control cycles, and restarted with the state in its newest record.
  void kill_and_restart();
  void clear_trip() { loop_->clear_trip(); }
  /// The next clock step of a time server or a person, within the next control cycle.
  void step_clock();

 private:
  CycleRecord run();
  void start();

  ControlSettings settings_;
  std::optional<Loop> loop_;
  TrialLog log_;
  std::int64_t cycles_ = 0;
  std::size_t clock_steps_ = 0;
};

/// Settings of a controller of such a battery.
ControlSettings trial_settings(const HonestVariant& variant);

struct FaultCase {
  const TrialFault* fault = nullptr;
  FaultTimes times{};
  Orders orders = Orders::kCharge;
  double soc_frac = 0.45;
  bool is_killed = false;  ///< the controller, after each control cycle
  int step_every = 0;      ///< the clock is stepped after this number of control cycles; 0 = never
  int cycles_max = 0;      ///< 0 = fault_cycles_max
};

/// A fault is found when the battery is stopped.
struct FaultResult {
  int cycles = 0;                    ///< since the fault, including the one that finds it
  Reason reason = Reason::kStudent;  ///< kStudent: not found
  bool is_trip = false;
  double wrong_wh = 0;
  double wrong_until_reported_wh = 0;  ///< until `status` reports its sum; 0 = never
  int driven_after = 0;         ///< of the next thirty cycles, those with an order other than 0 W
  int weak_answers = 0;         ///< maximum number of findings reported
  int reported_cycles = 0;      ///< until missing or lost energy was reported; 0 = never
  ResponseFindings reported{};  ///< the last of it
};

/// Two hours; of real prices a day.
constexpr int fault_cycles_max(Orders orders) { return orders == Orders::kRealDay ? 720 : 60; }
inline constexpr int kCyclesAfter = 30;

FaultResult try_fault(const FaultCase& c);

struct HonestDays {
  int cycles = 0;
  int driven = 0;  ///< with an order other than 0 W
  int trips = 0;   ///< each cleared immediately
  Reason first_trip = Reason::kStudent;
  int first_trip_cycle = 0;
  std::int32_t wrong_energy_e6_max = 0;
  double moved_wh = 0;
};

/// After this number of control cycles each; 0 = never.
struct Disturbances {
  int kill_every = 0;  ///< the controller
  int step_every = 0;  ///< the clock is stepped
};
HonestDays live_honest_days(const HonestVariant& variant, int days, const Disturbances& often = {});

/// The benchmark of tests/data.
const MinuteSeries& real_prices();

}  // namespace bess::trial
