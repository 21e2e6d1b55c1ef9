// Control loop behind a wrong meter, against houses with moving loads: how long limits are exceeded
// after a step of the battery has contradicted the meter, the number of control cycles until
// detection, and no false accusation of a correct meter.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "shared/host/minute_file.h"
#include "tests/support/fake_plant.h"
#include "tests/support/moving_house.h"

namespace bess {
namespace {

/// Calls an observer every second.
struct WatchedClock : FakeClock {
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    if (!each_second) return FakeClock::sleep_until_utc_ns(utc_ns);
    while (now_ns < utc_ns) {
      now_ns = std::min(utc_ns, (now_ns / kNanosecondsPerSecond + 1) * kNanosecondsPerSecond);
      if (now_ns % kNanosecondsPerSecond == 0) each_second(now_ns / kNanosecondsPerSecond);
    }
    return !stop;
  }
  std::function<void(std::int64_t)> each_second;
};

/// The meter's value from the true one.
struct Lie {
  const char* name;
  bool frozen = false;
  double gain = 1;
  bool other_phase = false;  ///< sees a third of the house and not the battery
};

struct LyingMeter {
  Status read(std::int32_t& grid_power_w) {
    const std::int64_t now_s = clock.now_ns / kNanosecondsPerSecond;
    battery.physics.advance(clock.now_ns);
    const double grid_w = house.power_w(now_s) + battery.physics.power_w();
    if (!lies(now_s) || !lie.frozen) frozen_w = grid_w;
    grid_power_w =
        static_cast<std::int32_t>(std::lround(lies(now_s) ? shown_w(now_s, grid_w) : grid_w));
    return Status::kOk;
  }
  [[nodiscard]] bool lies(std::int64_t now_s) const { return now_s >= lies_from_s; }
  [[nodiscard]] double shown_w(std::int64_t now_s, double grid_w) const {
    if (lie.frozen) return frozen_w;
    return lie.other_phase ? house.power_w(now_s) / 3 : lie.gain * grid_w;
  }

  WatchedClock& clock;
  FakeBattery& battery;
  const MovingHouse& house;
  Lie lie{"none"};
  std::int64_t lies_from_s = INT64_MAX;
  double frozen_w = 0;
};

struct NoOutsideLimits {
  static Status read(OutsideLimit&, bool&) { return Status::kOk; }
};

using Site = SiteLimits<LyingMeter, NoOutsideLimits>;
using Loop = ControlLoop<FakeBattery, FakePrices, WatchedClock, Site>;

const MinuteSeries& real_prices() {
  static const MinuteSeries prices =
      read_minute_file(BESS_SOURCE_DIR "/tests/data/benchmark_minutes_2023.csv.gz");
  return prices;
}

struct Trial {
  Trial(const SiteSettings& settings, const MovingHouse& house, double soc = 0.5)
      : battery(clock, soc),
        prices(clock),
        meter{clock, battery, house},
        loop({.control = true, .guard = {}}, battery, prices, clock,
             Site(settings, &meter, nullptr)) {
    prices.price = [](std::int64_t utc_s) {
      const auto& minutes = real_prices().indicative;
      const double price = minutes[static_cast<std::size_t>(utc_s / 60) % minutes.size()];
      return std::isnan(price) ? 10'000 : static_cast<std::int32_t>(std::lround(100 * price));
    };
  }
  CycleRecord cycle() {
    battery.orders.clear();
    return run_cycle(loop);
  }

  WatchedClock clock;
  FakeBattery battery;
  FakePrices prices;
  LyingMeter meter;
  Loop loop;
};

TEST(MeterLiars, ACorrectMeterIsNeverAccused) {
  constexpr int kDays = 30;
  for (const MovingHouse::Habits& habits : kMovingHouses) {
    int accused = 0;
    for (std::uint64_t seed = 1; seed <= 3; ++seed) {
      const MovingHouse house(habits, kDayStartS, kDays + 1, seed);
      Trial trial(metered(), house);
      if (seed == 2) trial.battery.physics.set_habits({.delay_s = 5, .noise_frac = 0.02});
      for (int i = 0; i < kDays * kStepsPerDay; ++i) {
        accused += trial.cycle().site.trust.is_mismatch;
      }
    }
    EXPECT_EQ(accused, 0) << habits.name;
  }
}

/// Earnings in EUR of some days close to the limits.
double earned_eur(const MovingHouse::Habits& habits, bool judges) {
  constexpr int kDays = 6;
  const MovingHouse house(habits, kDayStartS, kDays + 1, 1);
  SiteSettings settings = metered({.import_w_max = 6'000, .export_w_max = 3'000});
  settings.meter_check.judges = judges;
  Trial trial(settings, house);
  double eur = 0;
  trial.clock.each_second = [&](std::int64_t now_s) {
    trial.battery.physics.advance(trial.clock.now_ns);
    eur -= trial.battery.physics.power_w() / 3.6e9 * trial.prices.price(now_s) / 100;
  };
  for (int i = 0; i < kDays * kStepsPerDay; ++i) trial.cycle();
  return eur;
}

/// Doubts and possible ratios reduce power where the limits are near: in most houses very little.
TEST(MeterLiars, ACorrectMeterCostsLittle) {
  for (const MovingHouse::Habits& habits : kMovingHouses) {
    const double believed_eur = earned_eur(habits, false);
    const double judged_eur = earned_eur(habits, true);
    EXPECT_GT(judged_eur, (habits.pv_w > 0 ? 0.94 : 0.985) * believed_eur) << habits.name;
  }
}

// --- liars -------------------------------------------------------------------------------------

constexpr double kImportW = 6'000;
constexpr double kExportW = 3'000;
constexpr std::int64_t kLieAfterS = 3 * 3'600;

/// Cost of a meter fault, from the battery's first step on.
struct Damage {
  int over_s = 0;           ///< limit passed through the battery, until detection
  int cycles_to_find = -1;  ///< from that step on
  int steps_to_find = 0;    ///< of the battery, by at least an eighth of its rating
};

class Witnessed {
 public:
  Witnessed(Trial& trial, const Lie& lie) : trial_(trial) {
    trial.meter.lie = lie;
    trial.meter.lies_from_s = trial.clock.now_ns / kNanosecondsPerSecond + kLieAfterS;
    trial.clock.each_second = [this](std::int64_t now_s) { see(now_s); };
  }
  Damage run(int cycles) {
    for (int i = 0; i < cycles; ++i) {
      const CycleRecord record = trial_.cycle();
      if (step_s_ == 0) continue;
      const bool is_found = record.site.trust.is_mismatch;
      if (damage_.cycles_to_find < 0 && is_found) {
        damage_.cycles_to_find = static_cast<int>((record.utc_s - step_s_) / kSecondsPerStep) + 1;
        damage_.steps_to_find = steps_;
      }
    }
    return damage_;
  }

 private:
  void see(std::int64_t now_s) {
    trial_.battery.physics.advance(trial_.clock.now_ns);
    const double battery_w = trial_.battery.physics.power_w();
    const bool steps = std::abs(battery_w - before_w_) >= 500;
    before_w_ = battery_w;
    if (!trial_.meter.lies(now_s) && step_s_ == 0) return;
    if (steps && step_s_ == 0) step_s_ = now_s;
    if (steps && damage_.cycles_to_find < 0) ++steps_;
    if (step_s_ == 0) return;
    const double house_w = trial_.meter.house.power_w(now_s);
    const double grid_w = house_w + battery_w;
    const double over_w =
        std::max(grid_w - std::max(kImportW, house_w), -grid_w - std::max(kExportW, -house_w));
    if (over_w > 1 && damage_.cycles_to_find < 0) ++damage_.over_s;
  }

  Trial& trial_;
  Damage damage_;
  double before_w_ = 0;
  std::int64_t step_s_ = 0;  ///< the first one under the fault
  int steps_ = 0;
};

constexpr Lie kLies[] = {
    {.name = "frozen", .frozen = true}, {.name = "inverted", .gain = -1},
    {.name = "x 0.1", .gain = 0.1},     {.name = "x 0.5", .gain = 0.5},
    {.name = "x 10", .gain = 10},       {.name = "x 0.65", .gain = 0.65},
    {.name = "x 1.5", .gain = 1.5},     {.name = "other phase", .other_phase = true},
};

/// Steps every few control cycles, of either sign.
std::function<std::int32_t(std::int64_t)> restless_price(std::uint64_t seed) {
  return [seed](std::int64_t utc_s) {
    const auto slot = static_cast<std::uint64_t>(utc_s / 360) * 2'654'435'761U + seed * 97;
    return std::array{-60'000, 160'000, 10'000, -60'000, 160'000}[slot / 7 % 5];
  };
}

Damage worst_damage(const Lie& lie, const MovingHouse::Habits& habits) {
  Damage worst;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const MovingHouse house(habits, kDayStartS, 2, seed);
    Trial trial(metered({.import_w_max = 6'000, .export_w_max = 3'000}), house);
    trial.prices.price = restless_price(seed);
    Witnessed witnessed(trial, lie);
    const Damage damage = witnessed.run(12 * 30);
    worst.over_s = std::max(worst.over_s, damage.over_s);
    const bool is_slower = damage.cycles_to_find < 0 || worst.cycles_to_find >= 0;
    if (seed == 1 || (is_slower && (damage.cycles_to_find < 0 ||
                                    damage.cycles_to_find > worst.cycles_to_find))) {
      worst.cycles_to_find = damage.cycles_to_find;
      worst.steps_to_find = damage.steps_to_find;
    }
  }
  return worst;
}

/// Wrong at every step: found within a handful. Most of the other ratios are found late.
bool is_gross(const Lie& lie) { return lie.frozen || lie.other_phase || lie.gain <= 0.1; }

TEST(MeterLiars, ALimitIsPassedForAMinuteAtMostOnceAStepHasContradicted) {
  for (const MovingHouse::Habits& habits : kMovingHouses) {
    for (const Lie& lie : kLies) {
      const Damage now = worst_damage(lie, habits);
      // In the most restless house a correct meter exceeds them longer, house by house.
      const bool is_wild = habits.hob && habits.pv_w > 0;
      EXPECT_LE(now.over_s, is_wild ? 90 : 60) << habits.name << ", " << lie.name;
      if (!is_gross(lie)) continue;
      EXPECT_GE(now.cycles_to_find, 1) << habits.name << ", " << lie.name;
      EXPECT_LE(now.steps_to_find, 8) << habits.name << ", " << lie.name;
    }
  }
}

// --- the quarter-hour's cap --------------------------------------------------------------------

/// Quarter-hours above the cap, or above the house load if that is more, caused by the battery.
int quarters_above_cap(const Lie& lie, const MovingHouse::Habits& habits) {
  constexpr double kCapW = 4'000;
  int quarters = 0;
  for (std::uint64_t seed = 1; seed <= 5; ++seed) {
    const MovingHouse house(habits, kDayStartS, 2, seed);
    Trial trial(metered({.peak_w_max = 4'000}), house, 0.2);
    trial.prices.price = restless_price(seed);
    trial.meter.lie = lie;
    trial.meter.lies_from_s = trial.clock.now_ns / kNanosecondsPerSecond + kLieAfterS;
    double import_ws = 0, house_ws = 0, before_w = 0;
    bool has_stepped = false;
    trial.clock.each_second = [&](std::int64_t now_s) {
      trial.battery.physics.advance(trial.clock.now_ns);
      const double battery_w = trial.battery.physics.power_w();
      has_stepped |= trial.meter.lies(now_s) && std::abs(battery_w - before_w) >= 500;
      before_w = battery_w;
      const double house_w = house.power_w(now_s);
      import_ws += std::max(house_w + battery_w, 0.0);
      house_ws += std::max(house_w, 0.0);
      if (now_s % kQuarterHourS != 0) return;
      const double over_w = (import_ws - std::max(kCapW * kQuarterHourS, house_ws)) / kQuarterHourS;
      import_ws = house_ws = 0;
      if (has_stepped && over_w >= 10) ++quarters;
    };
    for (int i = 0; i < 12 * 30; ++i) trial.cycle();
  }
  return quarters;
}

TEST(MeterLiars, ThePeakCapIsHeld) {
  for (const MovingHouse::Habits& habits : kMovingHouses) {
    for (const Lie& lie : kLies) {
      if (!is_gross(lie)) continue;
      EXPECT_EQ(quarters_above_cap(lie, habits), 0) << habits.name << ", " << lie.name;
    }
  }
}

}  // namespace
}  // namespace bess
