// Lost orders on every shipped map: another controller releases the battery, writes another mode or
// power, or the device ends them, at every, every other or every third tick; the number of control
// cycles until detection. And unintended losses, which must not be found.
#include <gtest/gtest.h>

#include <functional>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/supervised_site.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

constexpr std::int32_t kForeignW = -1'700;
constexpr int kTrialCycles = 40;

std::int64_t now_s(const SupervisedSite& site) {
  return site.clock.now_utc_ns() / kNanosecondsPerSecond;
}

/// Action of another controller, or the device, on an order.
struct Interference {
  enum class Kind { kRelease, kMode, kPower, kEnd };
  Kind kind;
  const char* name;
  std::function<void(SupervisedSite&)> act;
};

const std::vector<Interference> kInterferences = {
    {Interference::Kind::kRelease, "gives it back",
     [](SupervisedSite& s) { s.device.image.release_from_outside(); }},
    {Interference::Kind::kMode, "another mode",
     [](SupervisedSite& s) { s.device.image.change_mode_from_outside(); }},
    {Interference::Kind::kPower, "another power",
     [](SupervisedSite& s) { s.device.image.order_from_outside(kForeignW); }},
    {Interference::Kind::kEnd, "the device ends it",
     [](SupervisedSite& s) {
       s.device.battery.stop_dispatch();
       s.device.image.refresh(s.clock.now_utc_ns());
     }},
};

/// What a map's registers can show.
struct Shows {
  bool replaced = true;
  bool ended = true;
  /// A release, or a change of mode, writes no more than the device does at an order's end.
  bool release_is_end = false;
  bool mode_is_end = false;
  bool has_mode = true;  ///< orders need one that another controller may change
};

Shows what_it_shows(const MapVariant& v) {
  const std::string name = std::string(v.map) + " " + v.variant;
  if (name == "alphaess ten_and_one") return {.release_is_end = true};
  if (name == "simulator ") return {.mode_is_end = true};
  if (name == "sungrow_sh external_ems") return {.release_is_end = true};
  if (name == "sungrow_sh forced") return {.ended = false};
  if (name == "sma bms_mode") return {.ended = false};
  if (name == "sma setpoint") return {.replaced = false, .ended = false};
  if (std::string(v.map) == "victron_ess3") return {.ended = false};
  if (std::string(v.map) == "goodwe_et") return {.ended = false};
  if (name == "solaredge ") return {.ended = false};
  if (name == "kostal_plenticore ") return {.ended = false, .has_mode = false};
  return {};
}

bool shows(const Shows& map, Interference::Kind kind) {
  if (kind == Interference::Kind::kMode && !map.has_mode) return false;
  return kind == Interference::Kind::kEnd ? map.ended : map.replaced;
}

Reason found_as(const Shows& map, Interference::Kind kind) {
  const bool is_end = kind == Interference::Kind::kEnd ||
                      (kind == Interference::Kind::kRelease && map.release_is_end) ||
                      (kind == Interference::Kind::kMode && map.mode_is_end);
  return is_end ? Reason::kNoAnswer : Reason::kOtherMaster;
}

/// 30 s after every `every`th tick.
void interfere(SupervisedSite& site, const Interference& what, int every) {
  site.clock.every_half_minute = [&site, &what, every] {
    const std::int64_t s = now_s(site);
    if (s % kSecondsPerStep != 30 || s / kSecondsPerStep % every != 0) return;
    site.device.image.refresh(site.clock.now_utc_ns());
    what.act(site);
  };
}

struct Outcome {
  int cycles_to_find = 0;  ///< from the first disturbed order until the release; 0: never
  int cycles_to_tell = 0;  ///< likewise, until health is degraded by it
  Reason reason = Reason::kStudent;
  CycleRecord last;
};

Outcome run_trial(SupervisedSite& site, const Interference& what, int every) {
  for (int i = 0; i < 8; ++i) site.cycle();
  interfere(site, what, every);
  Outcome outcome;
  for (int i = 0; i < kTrialCycles; ++i) {
    const CycleRecord& record = outcome.last = site.cycle();
    if (outcome.cycles_to_find == 0 && is_stop_reason(record.reason)) {
      outcome.cycles_to_find = i + 1;
      outcome.reason = record.reason;
    }
    if (outcome.cycles_to_tell == 0 && record.lost_orders.is_found) outcome.cycles_to_tell = i + 1;
  }
  return outcome;
}

class EveryMapsOrders : public ::testing::TestWithParam<MapVariant> {};

void expect_found(const Outcome& o, Reason reason, int every) {
  constexpr int kMost[] = {0, 3, 6, 9};
  EXPECT_GT(o.cycles_to_find, 0);
  EXPECT_LE(o.cycles_to_find, kMost[every]);
  EXPECT_EQ(o.reason, reason);
  EXPECT_GT(o.last.replaced_orders + o.last.ended_orders, 1);
  EXPECT_EQ(o.last.replaced_orders == 0, o.reason == Reason::kNoAnswer);
}

/// With insist control stops after an hour, unless two of three orders last.
void expect_reported(const Outcome& o, int every) {
  EXPECT_GT(o.cycles_to_tell, 0);
  EXPECT_LE(o.cycles_to_tell, 3 * every);
  EXPECT_GE(o.cycles_to_find, every == 3 ? 0 : 31);
  EXPECT_LE(o.cycles_to_find, every == 3 ? 0 : 34);
}

TEST_P(EveryMapsOrders, AnotherControllerIsFoundAlsoWhenIntermittent) {
  const Shows map = what_it_shows(GetParam());
  for (const Interference& what : kInterferences) {
    if (!shows(map, what.kind)) continue;  // a refresh may hide it
    for (const int every : {1, 2, 3}) {
      for (const bool yields : {true, false}) {
        SCOPED_TRACE(std::string(what.name) + " every " + std::to_string(every));
        ControlSettings settings;
        settings.supervision.yields_to_other_master = yields;
        SupervisedSite site(GetParam(), settings);
        trade_both_ways(site);
        const Outcome o = run_trial(site, what, every);
        if (yields) {
          expect_found(o, found_as(map, what.kind), every);
        } else {
          expect_reported(o, every);
        }
      }
    }
  }
}

/// Unintended ends of orders: called every 30 s, true when it has happened.
struct Innocent {
  const char* name;
  std::function<bool(SupervisedSite&, std::int64_t cycle, std::int64_t second)> happens;
  std::function<void(SupervisedSite&)> begin = [](SupervisedSite&) {};
};

/// Registers and dispatch as after a power cut of the device.
void reboot(SupervisedSite& site) {
  site.device.image.refresh(site.clock.now_utc_ns());
  site.device.image.release_from_outside();
}

/// By its own limits, a little inside those of the order.
bool is_full_or_empty(const SimulatedBattery& battery) {
  const double power_w = battery.commanded_power_w();
  return (power_w > 0 && battery.soc_frac() >= 0.955) ||
         (power_w < 0 && battery.soc_frac() <= 0.195);
}

auto process_is_stopped(std::int64_t seconds) {
  return [seconds](SupervisedSite& s, std::int64_t cycle, std::int64_t second) {
    const bool now = cycle % 3 == 0 && second == 60;
    if (now) s.device.test.device.now_ns += seconds * kNanosecondsPerSecond;
    return now;
  };
}

/// Alternating.
auto clock_steps(std::int64_t every, std::int64_t step_s) {
  return [every, step_s](SupervisedSite& s, std::int64_t cycle, std::int64_t second) {
    const bool now = second == 60 && cycle % every == 2;
    if (now) s.clock.step_ns += (cycle % 2 == 0 ? step_s : -step_s) * kNanosecondsPerSecond;
    return now;
  };
}

void set_link(SupervisedSite& site, bool is_up) {
  site.device.test.device.exception = is_up ? 0 : -1;
}

bool end_order(SupervisedSite& site) {
  site.device.battery.stop_dispatch();
  site.device.image.refresh(site.clock.now_utc_ns());
  return true;
}

const std::vector<Innocent> kInnocents = {
    {"a process that is stopped for twenty minutes", process_is_stopped(1'200)},
    {"a process that is stopped for three minutes", process_is_stopped(180)},
    {"a device that boots for four minutes",
     [](SupervisedSite& s, std::int64_t cycle, std::int64_t second) {
       if (cycle % 12 == 5 && second == 30) set_link(s, true);
       if (cycle % 12 != 3 || second != 30) return false;
       set_link(s, false);
       reboot(s);
       return true;
     }},
    {"a device that boots for a minute",
     [](SupervisedSite& s, std::int64_t cycle, std::int64_t second) {
       if (cycle % 6 == 3 && second == 90) set_link(s, true);
       if (cycle % 6 != 3 || second != 30) return false;
       set_link(s, false);
       reboot(s);
       return true;
     }},
    {"a link that is cut for eight minutes",
     [](SupervisedSite& s, std::int64_t cycle, std::int64_t second) {
       const bool is_up = cycle % 9 / 4 != 1;
       if (second == 30) set_link(s, is_up);
       return !is_up;
     }},
    {"a link that is away at every other reading",
     [](SupervisedSite& s, std::int64_t cycle, std::int64_t second) {
       const bool is_away = cycle % 2 == 0 && second == 90;
       set_link(s, !is_away);
       return is_away;
     }},
    {"a battery that ends orders when it is full or empty",
     [](SupervisedSite& s, std::int64_t, std::int64_t) {
       s.device.image.refresh(s.clock.now_utc_ns());
       return is_full_or_empty(s.device.battery) && end_order(s);
     },
     [](SupervisedSite& s) {  // three hours of one price, then of the other
       s.prices.price = [](std::int64_t minute_utc_s) {
         return minute_utc_s / 10'800 % 2 == 0 ? -60'000 : 160'000;
       };
     }},
    {"a device that follows no order of 0 W",
     [](SupervisedSite& s, std::int64_t, std::int64_t second) {
       s.device.image.refresh(s.clock.now_utc_ns());
       const bool rests =
           s.device.battery.dispatch_active() && s.device.battery.commanded_power_w() == 0;
       return second != 0 && rests && end_order(s);
     },
     [](SupervisedSite& s) {  // full for the guard after the first charging
       s.prices.price = [](std::int64_t minute_utc_s) {
         return minute_utc_s / 3'600 % 4 == 0 ? 160'000 : -60'000;
       };
     }},
    {"a clock that steps by an hour", clock_steps(5, 3'600)},
    {"a clock that steps by seventy seconds", clock_steps(3, 70)},
    {"prices that are away for half an hour",
     [](SupervisedSite& s, std::int64_t, std::int64_t) { return !s.prices.published(now_s(s)); },
     [](SupervisedSite& s) {
       s.prices.published = [](std::int64_t minute_utc_s) { return minute_utc_s / 1'800 % 2 == 0; };
     }},
};

TEST_P(EveryMapsOrders, UnintendedEndsAreNotFound) {
  for (const Innocent& innocent : kInnocents) {
    SCOPED_TRACE(innocent.name);
    SupervisedSite site(GetParam());
    trade_both_ways(site);
    innocent.begin(site);
    std::int64_t cycle = 0;
    int happened = 0;
    std::set<std::pair<std::int64_t, std::int64_t>> asked;  // once each
    site.clock.every_half_minute = [&] {
      const std::int64_t second = now_s(site) % kSecondsPerStep;
      const bool is_new = asked.insert({cycle, second}).second;
      if (is_new && innocent.happens(site, cycle, second)) ++happened;
    };
    std::map<Reason, int> reasons;
    for (cycle = 0; cycle < 300; ++cycle) ++reasons[site.cycle().reason];
    // Where the registers show no end, the simulator's next end waits for an order that differs.
    EXPECT_GE(happened, what_it_shows(GetParam()).ended ? 20 : 0);
    EXPECT_EQ(reasons[Reason::kOtherMaster], 0);
    EXPECT_EQ(reasons[Reason::kNoAnswer], 0);
  }
}

/// A new process finds the previous order, and cannot judge what happened in between.
TEST_P(EveryMapsOrders, RestartsLoseNone) {
  SupervisedSite site(GetParam());
  trade_both_ways(site);
  for (int cycle = 0; cycle < 200; ++cycle) {
    const CycleRecord record = site.cycle();
    ASSERT_FALSE(is_stop_reason(record.reason)) << reason_name(record.reason);
    ASSERT_EQ(record.replaced_orders + record.ended_orders, 0);
    if (cycle % 3 == 2) site.start();
  }
}

/// One request in two hundred is unanswered or refused as busy, and a gateway is busy, silent or
/// without its device for some seconds about once an hour: no stop results.
TEST_P(EveryMapsOrders, OrdinaryBusFaultsStopNothing) {
  SupervisedSite site(GetParam());
  site.prices.price = [](std::int64_t minute_utc_s) {  // it is never paused for long
    return static_cast<std::int32_t>(minute_utc_s / 240 % 2 == 0 ? -60'000 : 160'000) +
           static_cast<std::int32_t>(minute_utc_s / 60 % 7);
  };
  constexpr int kTroubles[] = {-1, 5, 6, 10, 11};
  std::mt19937 random(520'007);
  RegisterDevice& device = site.device.test.device;
  std::int64_t spell_begin_ns = 0;
  std::int64_t spell_end_ns = 0;
  int trouble = 0;
  int faults = 0;
  device.before_request = [&, refresh = device.before_request] {
    refresh();
    if (device.now_ns > spell_end_ns) {
      spell_begin_ns = device.now_ns + (random() % 7'200) * kNanosecondsPerSecond;
      spell_end_ns = spell_begin_ns + (3 + random() % 10) * kNanosecondsPerSecond;
      trouble = kTroubles[random() % std::size(kTroubles)];
    }
    const bool is_spell = device.now_ns >= spell_begin_ns;
    const bool is_alone = random() % 200 == 0;
    device.exception = is_spell ? trouble : is_alone ? kTroubles[random() % 5] : 0;
    if (device.exception != 0) ++faults;
  };
  const int cycles = 720 * few_or_all(3, 30);
  std::map<Reason, int> stops;
  for (int i = 0; i < cycles; ++i) {
    const CycleRecord record = site.cycle();
    if (is_stop_reason(record.reason)) ++stops[record.reason];
  }
  EXPECT_GT(faults, cycles / 50);
  for (const auto& [reason, count] : stops) {
    EXPECT_EQ(count, 0) << reason_name(reason) << " in " << cycles << " cycles";
  }
}

INSTANTIATE_TEST_SUITE_P(Maps, EveryMapsOrders, ::testing::ValuesIn(kShippedMapVariants));

}  // namespace
}  // namespace bess
