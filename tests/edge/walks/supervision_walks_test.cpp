// Walks over edge/supervision: batteries that follow, lag, lie and look after themselves, by the
// thousand readings, and every finding about them.
#include <algorithm>

#include "edge/supervision/energy_balance.h"
#include "edge/supervision/energy_path.h"
#include "edge/supervision/leaky_count.h"
#include "edge/supervision/lost_orders.h"
#include "edge/supervision/response_monitor.h"
#include "edge/supervision/supervision.h"
#include "tests/edge/walks/walk.h"

namespace bess {
namespace {

ResponseSettings drawn_settings(Walk& walk, int block) {
  ResponseSettings s;
  s.power_w = static_cast<std::int32_t>(walk.one_of({2'000, 4'000, 40'000}));
  s.capacity_wh = s.power_w * 2;
  s.band.settle_s = static_cast<std::int32_t>(walk.one_of({5, 20, 60}));
  s.band.tolerance_percent = static_cast<std::int32_t>(walk.one_of({10, 15, 30}));
  s.band.tolerance_w = static_cast<std::int32_t>(walk.one_of({50, 200}));
  s.band.soc_step_e4 = static_cast<std::int32_t>(walk.one_of({1, 10, 100}));
  s.band.soc_refresh_s = block % 4 == 3 ? 300 : static_cast<std::int32_t>(walk.one_of({60, 61, 1}));
  s.band.charges_by_itself = block % 5 == 4;
  return s;
}

/// A battery of integers with a fault for a while, and an order that changes now and then.
struct WalkedBattery {
  enum Fault {
    kNone,
    kInverted,
    kDead,
    kWeak,
    kExcess,
    kDrain,
    kStuck,
    kDrift,
    kSlow,
    kJump,
    kCare,
    kFaults
  };
  ResponseSettings settings;
  std::int64_t charge_ws = 0;  ///< of the capacity
  std::int32_t power_w = 0;
  std::int32_t shown_e4 = 5'000;
  std::int32_t ordered_w = 0;
  std::int64_t order_number = 1;
  std::int64_t ordered_s = 0;
  std::int64_t steady_s = 100'000;
  bool is_driven = true;
  int fault = kNone;

  [[nodiscard]] std::int64_t capacity_ws() const {
    return std::int64_t{3'600} * settings.capacity_wh;
  }

  std::int32_t aimed_w(Walk& walk) const {
    switch (fault) {
      case kInverted:
        return -ordered_w;
      case kDead:
        return 0;
      case kWeak:
        return ordered_w * 6 / 10;
      case kExcess:
        return ordered_w + walk.edge({2 * settings.noise_w(), settings.power_w / 2});
      case kDrain:
        return ordered_w == 0 ? -walk.edge({2 * settings.noise_w()}) : ordered_w;
      case kCare:
        return ordered_w <= 0 ? settings.power_w / 10 : ordered_w;
      default:
        return ordered_w;
    }
  }

  Response step(Walk& walk, std::int64_t seconds) {
    steady_s += seconds;
    const std::int32_t aim_w = aimed_w(walk);
    const std::int32_t most_w =
        fault == kSlow ? static_cast<std::int32_t>(settings.power_w * seconds / 170) : 1'000'000;
    const std::int32_t jitter_w = walk.number(-20, 20);
    power_w = std::clamp(aim_w + jitter_w, power_w - most_w, power_w + most_w);
    if ((charge_ws <= 0 && power_w < 0) || (charge_ws >= capacity_ws() && power_w > 0)) power_w = 0;
    charge_ws = std::clamp<std::int64_t>(charge_ws + power_w * seconds, 0, capacity_ws());
    if (fault == kDrift) charge_ws = std::max<std::int64_t>(charge_ws - 800 * seconds, 0);
    if (fault == kJump && walk.once_in(6)) charge_ws = walk.from(0, capacity_ws());
    const auto soc_e4 = static_cast<std::int32_t>(charge_ws * 10'000 / capacity_ws());
    const std::int32_t step_e4 = std::max(settings.band.soc_step_e4, 10);
    if (fault != kStuck && (settings.band.soc_refresh_s <= 61 || walk.once_in(3))) {
      shown_e4 = soc_e4 / step_e4 * step_e4;
    }
    Response now{.utc_s = steady_s,
                 .steady_s = steady_s,
                 .is_driven = is_driven,
                 .order_number = order_number,
                 .ordered_power_w = ordered_w,
                 .order_age_s = static_cast<std::int32_t>(steady_s - ordered_s),
                 .measurement = {}};
    now.measurement.soc_e4 = shown_e4;
    now.measurement.power_w = power_w;
    now.measurement.capacity_wh = settings.capacity_wh;
    return now;
  }

  void order(Walk& walk, std::int64_t age_s) {
    static constexpr int kShares[] = {-8, -8, -4, -1, 0, 0, 1, 4, 8, 8};
    const std::int32_t before_w = ordered_w;
    ordered_w = settings.power_w * kShares[walk.from(0, 9)] / 8;
    ++order_number;
    if (ordered_w != before_w) ordered_s = steady_s - age_s;
  }
};

/// What a device may tell besides.
void draw_words(Walk& walk, Response& now) {
  BatteryMeasurement& m = now.measurement;
  if (walk.once_in(25)) m.temperature_min_deci_c = walk.edge({80});
  if (walk.once_in(20)) m.charge_w_max = walk.edge({0, 200, 1'000, 4'000});
  if (walk.once_in(20)) m.discharge_w_max = walk.edge({0, 200, 1'000, 4'000});
  if (walk.once_in(60)) m.alarm = true;
  if (walk.once_in(60)) m.off_grid = true;
  if (walk.once_in(500)) m.power_w = walk.once_in(2) ? INT32_MIN : INT32_MAX;
  if (walk.once_in(300)) m.capacity_wh = walk.edge({0, 3'000, 20'000});
  if (walk.once_in(9)) now.soc_floor_e4 = walk.edge({0, 1'000, 2'000});
  if (walk.once_in(9)) now.soc_ceiling_e4 = walk.edge({9'000, 10'000}, 0);
}

void see_monitor(Walk& walk, const ResponseMonitor& m) {
  const ResponseFindings f = m.findings();
  walk.see(m.trip(), m.gives_no_answer(), m.looks_after_itself(), m.needs_no_care(), m.has_jumped(),
           m.has_answered(), m.weak_answers(), m.unanswered_orders(), f.energy_share_percent,
           f.rest_loss_w, f.ramp_w_per_s, f.locked_readings, f.wrong_energy_e6);
}

std::int64_t drawn_seconds(Walk& walk) {
  if (walk.once_in(120)) return walk.edge({0, 300, 400});
  return walk.once_in(10) ? walk.from(1, 240) : 120;
}

TEST(SupervisionWalk, Responses) {
  Walk walk("responses");
  for (int block = 0; block < 160; ++block) {
    WalkedBattery battery{.settings = drawn_settings(walk, block)};
    battery.charge_ws = battery.capacity_ws() * walk.number(0, 10) / 10;
    ResponseMonitor monitor(battery.settings);
    const int usual_fault = block % WalkedBattery::kFaults;
    for (int i = 0; i < 400; ++i) {
      if (walk.once_in(12)) {
        battery.fault = walk.once_in(3) ? WalkedBattery::kNone : usual_fault;
      }
      if (walk.once_in(3)) {
        battery.order(walk, walk.once_in(4) ? walk.from(0, 70) : 0);
      }
      if (walk.once_in(25)) battery.is_driven = !battery.is_driven;
      if (!battery.is_driven && walk.once_in(2)) battery.is_driven = true;
      Response now = battery.step(walk, drawn_seconds(walk));
      draw_words(walk, now);
      if (walk.once_in(15)) {
        monitor.note_power(now);
        now = battery.step(walk, walk.from(1, 60));
      }
      monitor.observe(now);
      see_monitor(walk, monitor);
      if (monitor.trip() != Reason::kStudent && walk.once_in(5)) monitor.forget();
    }
    walk.end_line(block);
  }
  walk.hold();
}

/// Powers and ages where a judgement turns.
TEST(SupervisionWalk, ResponsesAtTheirBounds) {
  Walk walk("responses_at_their_bounds");
  for (int block = 0; block < 120; ++block) {
    const ResponseSettings s = drawn_settings(walk, block);
    ResponseMonitor monitor(s);
    const std::int32_t noise_w = s.noise_w();
    std::int64_t steady_s = 1'000;
    std::int32_t ordered_w = 0, before_w = 0;
    std::int64_t ordered_s = 0;
    for (int i = 0; i < 300; ++i) {
      steady_s += walk.once_in(10) ? walk.edge({300, 60, 20}) : 120;
      if (walk.once_in(2)) {
        ordered_w = walk.edge({0, noise_w, -noise_w, s.power_w, -s.power_w, 2 * noise_w});
        ordered_s =
            steady_s - (walk.once_in(2)
                            ? walk.edge({s.band.settle_s, s.band.settle_s + 10, 60, 180, 120})
                            : 110);
      }
      const std::int32_t tolerance_w = s.tolerance_w(ordered_w);
      const std::int32_t along = ordered_w < 0 ? -1 : 1;
      const std::int32_t magnitude_w = power_magnitude_w(ordered_w);
      const std::int64_t age_s = steady_s - ordered_s;
      const std::int64_t ramp_w =
          before_w + (ordered_w - before_w < 0 ? -1 : 1) *
                         (s.power_w * std::min<std::int64_t>(age_s, 120) / 180);
      const std::int32_t power_w =
          walk.once_in(3)
              ? walk.edge({0, 2 * noise_w, -2 * noise_w, noise_w, -noise_w, ramp_w, before_w})
              : along *
                    walk.edge({magnitude_w, magnitude_w + tolerance_w, magnitude_w - tolerance_w,
                               magnitude_w / 10, noise_w, -noise_w, s.power_w * 15 / 100});
      Response now{.utc_s = steady_s,
                   .steady_s = steady_s,
                   .is_driven = !walk.once_in(30),
                   .order_number = i,
                   .ordered_power_w = ordered_w,
                   .order_age_s = static_cast<std::int32_t>(age_s),
                   .measurement = {}};
      now.measurement.soc_e4 = walk.edge({1'200, 9'500, 8'000, 3'000, 5'000, 5'050});
      now.measurement.power_w = power_w;
      now.measurement.capacity_wh = s.capacity_wh;
      draw_words(walk, now);
      monitor.observe(now);
      see_monitor(walk, monitor);
      before_w = power_w;
      if (walk.once_in(6)) monitor.forget();
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(SupervisionWalk, EnergyBalance) {
  Walk walk("energy_balance");
  using Kind = EnergyInterval::Kind;
  for (int block = 0; block < 300; ++block) {
    EnergyBalance balance({.capacity_wh = 8'000,
                           .noise_w = walk.number(0, 4) * 50,
                           .charges_by_itself = walk.once_in(4)});
    const int share = walk.edge({-50, 0, 30, 40, 60, 70, 100, 150, 200, 250, 300}, 2);
    const int loss_e4 = walk.once_in(2) ? 0 : walk.number(-120, 120);
    const bool to_and_fro = walk.once_in(2);
    const std::int32_t span_e4 = static_cast<std::int32_t>(walk.one_of({1, 10, 100}));
    const int rest_share = walk.number(1, 6);
    for (int i = 0; i < 90; ++i) {
      EnergyInterval interval{.kind = Kind::kFlowing, .seconds = 120};
      if (walk.once_in(static_cast<std::uint64_t>(rest_share))) interval.kind = Kind::kResting;
      if (walk.once_in(30)) interval.kind = Kind::kUnknown;
      const int sign = to_and_fro && walk.once_in(2) ? -1 : 1;
      if (interval.kind == Kind::kFlowing) {
        interval.energy_e4 = static_cast<std::int16_t>(sign * walk.number(40, 170));
        interval.late_energy_e4 = interval.energy_e4;
        if (walk.once_in(4)) {
          interval.late_energy_e4 =
              static_cast<std::int16_t>(interval.energy_e4 * walk.number(-1, 3) / 4);
        }
        interval.power_w = interval.energy_e4 * 24;
      } else {
        interval.energy_e4 = static_cast<std::int16_t>(walk.number(-12, 2));
        interval.late_energy_e4 = interval.energy_e4;
        interval.power_w = walk.edge({0, -250, -300, 200}, 20);
      }
      interval.soc_e4 = static_cast<std::int16_t>(interval.energy_e4 * share / 100 - loss_e4 +
                                                  walk.number(-span_e4 / 2, span_e4 / 2));
      if (walk.once_in(200)) interval.soc_e4 = static_cast<std::int16_t>(walk.from(-3'000, 3'000));
      if (walk.once_in(60)) {
        balance.interrupt();
      } else {
        balance.observe(interval, span_e4);
      }
      walk.see(balance.findings().contradicts, balance.findings().share_percent,
               balance.findings().rest_loss_w);
    }
    if (block % 10 == 9) walk.end_line(block);
  }
  walk.hold();
}

TEST(SupervisionWalk, EnergyPath) {
  Walk walk("energy_path");
  for (int block = 0; block < 20; ++block) {
    EnergyPath path;
    std::int64_t steady_s = 1'000;
    path.begin(steady_s);
    for (int i = 0; i < 300; ++i) {
      steady_s += walk.once_in(10) ? 0 : walk.from(-2, 120);
      path.add(steady_s, walk.number(-4'000, 4'000));
      if (walk.once_in(150)) path.begin(steady_s);
      const EnergyRange range = path.since(steady_s - walk.edge({0, 60, 620, 4'000, 8'000}), 4'000);
      const EnergyRange change =
          range.since({walk.from(-9, 9) * 10'000, walk.from(-9, 9) * 10'000});
      walk.see(range.least_ws, range.most_ws, path.energy_ws(), change.least_ws, change.most_ws,
               range.surely_ws(), change.surely_ws());
    }
    walk.end_line(block);
  }
  LeakyCount count;
  for (int i = 0; i < 400; ++i) {
    if (walk.once_in(3)) {
      count.bad();
    } else {
      count.good();
    }
    if (walk.once_in(40)) count.restore(static_cast<std::int16_t>(walk.from(-3, 9)));
    if (walk.once_in(50)) count.forget();
    walk.see(count.level, count.is_found());
  }
  walk.end_line("leaky");
  walk.hold();
}

TEST(SupervisionWalk, LostOrders) {
  Walk walk("lost_orders");
  for (int block = 0; block < 80; ++block) {
    ResponseSettings settings;
    settings.power_w = block % 2 == 0 ? 4'000 : 40'000;
    const std::int32_t noise_w = settings.noise_w();
    LostOrders lost(settings);
    std::int64_t steady_s = 1'000'000;
    if (walk.once_in(3)) {
      LostOrderHistory before;
      for (int i = 0; i < block; ++i) before.note(walk.once_in(3));
      before.is_found = walk.once_in(2);
      if (walk.once_in(8)) before.judged = static_cast<std::int16_t>(walk.from(-3, 40));
      lost.restore(before, steady_s);
    }
    std::int64_t number = 1;
    const auto often = static_cast<std::uint64_t>(walk.number(2, 30));
    for (int i = 0; i < 300; ++i) {
      steady_s += walk.once_in(100) ? walk.edge({7'200, 3'600}) : 120;
      if (!walk.once_in(5)) ++number;
      Response now{.utc_s = steady_s,
                   .steady_s = steady_s,
                   .is_driven = !walk.once_in(12),
                   .order_number = number,
                   .ordered_power_w = walk.edge({0, noise_w, -noise_w, 4'000, -4'000}),
                   .soc_floor_e4 = 1'000,
                   .soc_ceiling_e4 = 10'000,
                   .measurement = {}};
      BatteryMeasurement& m = now.measurement;
      m.soc_e4 = walk.once_in(2) ? 5'000 : walk.edge({2'000, 9'500});
      m.power_w = walk.edge({0, noise_w, -noise_w, 4'000});
      if (walk.once_in(8)) m.charge_w_max = walk.edge({noise_w});
      if (walk.once_in(8)) m.discharge_w_max = walk.edge({noise_w});
      if (walk.once_in(8)) m.temperature_min_deci_c = walk.edge({80});
      m.alarm = walk.once_in(40);
      m.off_grid = walk.once_in(40);
      m.order_replaced = walk.once_in(often);
      m.order_ended = walk.once_in(often);
      lost.observe(now, walk.once_in(60));
      walk.see(lost.is_to_be_given_up(steady_s, true), lost.is_to_be_given_up(steady_s, false),
               lost.reason(), lost.has_settled(), lost.history().orders, lost.history().judged,
               lost.history().lost, lost.history().is_found, lost.replaced(), lost.ended());
      for (std::int64_t later_s = 0; later_s < 4'000; later_s += 120) {
        walk.see(lost.is_to_be_given_up(steady_s + later_s, false));
      }
      if (walk.once_in(90)) lost.forget_findings();
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(SupervisionWalk, Supervision) {
  Walk walk("supervision");
  for (int block = 0; block < 120; ++block) {
    WalkedBattery battery{.settings = drawn_settings(walk, block)};
    battery.charge_ws = battery.capacity_ws() * walk.number(0, 10) / 10;
    Supervision supervision({.response = battery.settings,
                             .capacity_wh_min = battery.settings.capacity_wh - 500,
                             .capacity_wh_max = battery.settings.capacity_wh + 500,
                             .yields_to_other_master = block % 3 != 0});
    const int usual_fault = block % WalkedBattery::kFaults;
    const auto often = static_cast<std::uint64_t>(walk.number(3, 40));
    for (int i = 0; i < 500; ++i) {
      if (walk.once_in(15)) {
        battery.fault = walk.once_in(4) ? WalkedBattery::kNone : usual_fault;
      }
      const bool is_stopped = supervision.stop_reason() != Reason::kStudent;
      battery.is_driven = !is_stopped || walk.once_in(10);
      if (walk.once_in(3)) battery.order(walk, 0);
      Response now = battery.step(walk, drawn_seconds(walk));
      if (walk.once_in(300)) now.utc_s += walk.from(-30'000, 30'000);
      draw_words(walk, now);
      if (walk.once_in(4))
        now.measurement.capacity_wh =
            walk.edge({battery.settings.capacity_wh - 500, battery.settings.capacity_wh + 500, 0});
      now.measurement.order_replaced = walk.once_in(often);
      now.measurement.order_ended = walk.once_in(often);
      now.measurement.dispatch_active = !walk.once_in(4);
      if (walk.once_in(40)) {
        supervision.recall(now);
      } else {
        supervision.observe(now, is_stopped);
      }
      if (walk.once_in(20)) supervision.note_power(battery.step(walk, walk.from(1, 40)));
      if (walk.once_in(10)) {
        supervision.on_ordered(now.utc_s, static_cast<Status>(walk.from(0, 6)));
      }
      walk.see(supervision.stop_reason(), supervision.trip().reason, supervision.trip().utc_s,
               supervision.lost_orders().history().orders, supervision.response().weak_answers());
      if (supervision.trip().is_set() && walk.once_in(12)) supervision.clear();
      if (walk.once_in(400)) {
        supervision.restore({.reason = Reason::kUncontrolledPower, .utc_s = now.utc_s});
      }
    }
    walk.end_line(block);
  }
  walk.hold();
}

}  // namespace
}  // namespace bess
