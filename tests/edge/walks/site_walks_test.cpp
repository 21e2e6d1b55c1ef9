// Walks over edge/site: houses, meters that lie, limits from outside, and the connection's bounds.
#include "edge/site/connection_guard.h"
#include "edge/site/house_watch.h"
#include "edge/site/meter_witness.h"
#include "edge/site/outside_limit.h"
#include "edge/site/site_limits.h"
#include "tests/edge/walks/walk.h"

namespace bess {
namespace {

constexpr std::int64_t kSiteStartS = 1'679'788'800;

void see_range(Walk& walk, const SiteRange& range) {
  walk.see(range.charge_w_max, range.discharge_w_max, range.charge_reason, range.discharge_reason,
           range.relief_w);
}

TEST(SiteWalk, Connection) {
  Walk walk("connection");
  for (int block = 0; block < 40; ++block) {
    ConnectionSettings s;
    if (block % 2 == 0) s.import_w_max = walk.number(1, 9) * 1'000;
    if (block % 3 == 0) s.export_w_max = walk.number(0, 9) * 1'000;
    if (block % 4 != 1) s.peak_w_max = walk.number(2, 6) * 1'000;
    s.house_rise_w = walk.number(0, 3) * 3'000;
    s.peak_shave = walk.once_in(3);
    s.order_stands_s = static_cast<std::int32_t>(walk.one_of({10, 30, 60}));
    for (int i = 0; i < 600; ++i) {
      ConnectionState state{.grid_w = walk.edge({0, 4'000, -4'000}, 2'500),
                            .battery_w = walk.edge({0, 4'000, -4'000}, 300),
                            .relief_w_max = walk.edge({0, 4'000}, 0)};
      state.quarter_hour.left_s =
          walk.once_in(3) ? walk.edge({2, 30, 60, 120, 899}) : walk.number(1, 900);
      const std::int64_t gone_s = 900 - state.quarter_hour.left_s;
      state.quarter_hour.import_ws = gone_s * walk.number(0, 7'000) + walk.from(-1, 1);
      state.quarter_hour.battery_ws = walk.once_in(3) ? 0 : gone_s * walk.number(0, 4'000);
      SiteRange range;
      limit_at_connection(s, walk.number(0, 2) * 100, state, range);
      see_range(walk, range);
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(SiteWalk, HouseWatch) {
  Walk walk("house_watch");
  for (int block = 0; block < 10; ++block) {
    HouseWatch watch;
    const std::int32_t pv_w = block == 0 ? kAnyPowerW : block * 1'000;
    for (int i = 0; i < 600; ++i) {
      const std::int32_t battery_w = walk.edge({0, 4'000, -4'000, 400});
      const std::int32_t error_w = 200 + std::abs(battery_w) / 20;
      const std::int32_t grid_w =
          walk.once_in(2) ? 500 : walk.edge({battery_w - std::int64_t{pv_w % 100'000} - error_w});
      const bool is_plausible = is_plausible_house(grid_w, battery_w, pv_w);
      watch.observe(is_plausible != (i / 40 % 2 == 1 && !walk.once_in(6)));
      walk.see(is_plausible, watch.is_implausible());
    }
    walk.end_line(block);
  }
  walk.hold();
}

void see_trust(Walk& walk, const MeterTrust& t) {
  walk.see(t.is_mismatch, t.doubt, t.pause_until_utc_s, t.pause_s, t.steps, t.step_squares,
           t.error_products, t.error_squares);
}

/// What a meter shows of a house and a battery, by how it lies.
std::int32_t shown_w(Walk& walk, int lie, std::int32_t house_w, std::int32_t battery_w,
                     std::int32_t before_w) {
  switch (lie) {
    case 1:
      return -(house_w + battery_w);
    case 2:
      return 1'234;
    case 3:
      return (house_w + battery_w) * walk.number(4, 6) / 10;
    case 4:
      return (house_w + battery_w) * walk.number(14, 22) / 10;
    case 5:
      return before_w;
    case 6:
      return house_w + battery_w / 2;
    case 7:
      return walk.once_in(3) ? -(house_w + battery_w) : house_w + battery_w;
    default:
      return house_w + battery_w;
  }
}

TEST(SiteWalk, MeterWitness) {
  Walk walk("meter_witness");
  for (int block = 0; block < 160; ++block) {
    MeterWitness witness({.judges = block % 40 != 39,
                          .power_w = walk.once_in(2) ? 4'000 : 10'000,
                          .settle_s = walk.once_in(2) ? 20 : 5});
    const std::int32_t rated_w = block % 2 == 0 ? 4'000 : 10'000;
    std::int64_t utc_s = kSiteStartS;
    std::int64_t ordered_s = utc_s;
    std::int32_t house_w = 600, battery_w = 0, aim_w = 0, before_w = 600;
    const int usual_lie = block % 8;
    int lie = 0;
    const auto restless = static_cast<std::uint64_t>(walk.number(4, 60));
    for (int i = 0; i < 700; ++i) {
      utc_s += walk.once_in(300)  ? walk.from(-4'000, 90'000)
               : walk.once_in(40) ? walk.edge({80, 90, 240, 600})
                                  : 10;
      if (walk.once_in(60)) lie = walk.once_in(3) ? 0 : usual_lie;
      if (walk.once_in(restless)) house_w = walk.number(-2'000, 5'000);
      if (i % 12 == 0) {
        static constexpr int kEighths[] = {-8, -8, 0, 1, 4, 8, 8};
        aim_w = rated_w * kEighths[walk.from(0, 6)] / 8;
        ordered_s = utc_s - walk.edge({1, 5, 20});
      }
      battery_w = walk.once_in(9) ? battery_w + (aim_w - battery_w) / 2 : aim_w;
      const std::int32_t grid_w = shown_w(walk, lie, house_w, battery_w, before_w);
      before_w = house_w + battery_w;
      witness.observe({.utc_s = utc_s,
                       .grid_w = walk.once_in(400) ? INT32_MIN : grid_w,
                       .battery_w = battery_w + walk.number(-30, 30),
                       .order = {.is_driven = !walk.once_in(50),
                                 .age_s = static_cast<std::int32_t>(utc_s - ordered_s)}});
      const std::int64_t asked_s = utc_s + walk.from(-10, 130);
      const MeterRatios ratios = witness.possible_ratios(asked_s + (walk.once_in(9) ? 1'200 : 0));
      see_trust(walk, witness.trust());
      walk.see(ratios.least_permille, ratios.most_permille, witness.power_w_max(asked_s),
               witness.is_mismatch());
      if (walk.once_in(500)) {
        witness.restore(
            {.is_mismatch = true, .doubt = 10, .pause_until_utc_s = utc_s + 30, .pause_s = 600});
      }
    }
    walk.end_line(block);
  }
  walk.hold();
}

/// Steps that miss by as much as a judgement turns at, in a house that stands still.
TEST(SiteWalk, MeterWitnessAtItsBounds) {
  Walk walk("meter_witness_at_its_bounds");
  for (int block = 0; block < 120; ++block) {
    MeterWitness witness({.power_w = 4'000, .settle_s = 20});
    std::int64_t utc_s = kSiteStartS;
    std::int32_t battery_w = 0, grid_w = 500, noise_w = 0;
    const std::int64_t usual = walk.one_of({0, 100, 500, 600, 1'100, 1'600, 1'700, 2'600});
    for (int i = 0; i < 60; ++i) {
      const std::int32_t next_w = walk.edge({0, 4'000, -4'000, 400, 1'000}, 2);
      const std::int32_t size_w = next_w - battery_w;
      const std::int32_t error_w = static_cast<std::int32_t>(
          walk.once_in(3) ? walk.edge({0, size_w / 4 + 100, size_w * 2 / 5, size_w / 10 + 100,
                                       size_w * 3 / 2, size_w * 5 / 2 + 200, 2 * (noise_w + 100)})
                          : size_w * usual / 1'000);
      battery_w = next_w;
      grid_w += size_w - error_w;
      utc_s += 100;
      for (int reading = 0; reading < 3; ++reading) {
        utc_s += 10;
        if (walk.once_in(20)) grid_w += noise_w = walk.number(0, 1'500);
        if (reading == 2 && walk.once_in(6)) {
          grid_w += walk.edge({error_w, error_w + error_w / 8 + 100, -2 * grid_w});
        }
        const std::int32_t age_s = walk.once_in(8) ? walk.edge({19, 20}) : 20 + 10 * reading;
        witness.observe({.utc_s = utc_s,
                         .grid_w = grid_w,
                         .battery_w = battery_w,
                         .order = {.is_driven = true, .age_s = age_s}});
        const MeterRatios ratios = witness.possible_ratios(utc_s);
        see_trust(walk, witness.trust());
        walk.see(ratios.least_permille, ratios.most_permille, witness.power_w_max(utc_s),
                 witness.power_w_max(utc_s + 120));
      }
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(SiteWalk, OutsideLimits) {
  Walk walk("outside_limits");
  const std::string good = "1000 any 2026-11-22T10:15:00Z\n";
  for (int i = 0; i < 6'000; ++i) {
    std::string text = good;
    if (walk.once_in(3)) text = "any 0 2026-11-22T10:15:00Z\n";
    const int changes = walk.number(0, 3);
    for (int c = 0; c < changes; ++c) {
      const auto at = static_cast<std::size_t>(walk.from(0, static_cast<int>(text.size()) - 1));
      switch (walk.from(0, 3)) {
        case 0:
          text.erase(at, 1);
          break;
        case 1:
          text.insert(at, 1, " 0a-\n"[walk.from(0, 4)]);
          break;
        case 2:
          text[at] = static_cast<char>('0' + walk.from(0, 12));
          break;
        default:
          text.resize(at);
          break;
      }
      if (text.empty()) text = " ";
    }
    OutsideLimit limit;
    walk.see(parse_outside_limit(text, limit), limit.charge_w_max, limit.discharge_w_max,
             limit.until_utc_s);
  }
  walk.end_line("lines");
  walk.hold();
}

struct WalkedMeter {
  Status status = Status::kOk;
  std::int32_t grid_w = 0;
  Status read(std::int32_t& shown_grid_w) {
    if (status == Status::kOk) shown_grid_w = grid_w;
    return status;
  }
};
struct WalkedLimits {
  Status status = Status::kOk;
  bool is_set = false;
  OutsideLimit limit;
  Status read(OutsideLimit& said, bool& said_set) {
    said = limit;
    said_set = is_set;
    return status;
  }
};

TEST(SiteWalk, SiteLimits) {
  Walk walk("site_limits");
  for (int block = 0; block < 120; ++block) {
    SiteSettings s;
    s.meter = static_cast<MeterSource>(block % 3);
    s.idle_without_meter = block % 5 != 0;
    s.age_s_max = walk.once_in(2) ? 30 : 15;
    s.connection = {.import_w_max = walk.once_in(2) ? kAnyPowerW : 5'000,
                    .export_w_max = walk.once_in(2) ? kAnyPowerW : 3'000,
                    .peak_w_max = walk.once_in(2) ? kAnyPowerW : 4'000,
                    .margin_w = walk.number(0, 4) * 101};
    s.witness = {.power_w = 4'000, .settle_s = 20};
    s.pv_w_max = walk.once_in(3) ? kAnyPowerW : walk.number(0, 2) * 1'000;
    s.has_outside_limits = block % 4 < 2;
    s.idle_after_timeout = block % 8 < 4;
    WalkedMeter meter;
    WalkedLimits outside;
    SiteLimits<WalkedMeter, WalkedLimits> site(s, &meter, &outside);
    walk.see(site.check_every_s(), site.needs_battery());
    std::int64_t utc_s = kSiteStartS;
    if (walk.once_in(3)) {
      SiteReport before{.quarter_hour_import_wh = 300, .quarter_hour_battery_wh = 100};
      before.trust = {
          .is_mismatch = walk.once_in(2), .pause_until_utc_s = utc_s + 300, .pause_s = 600};
      site.take_over(utc_s - 10, before);
    }
    std::int32_t battery_w = 0, house_w = 500;
    std::int64_t ordered_s = utc_s;
    const int lie = block % 9 == 0 ? block / 9 % 8 : 0;
    for (int i = 0; i < 250; ++i) {
      utc_s += walk.once_in(80) ? walk.from(-60, 1'000) : 10;
      if (walk.once_in(30)) house_w = walk.number(-3'000, 6'000);
      if (walk.once_in(12)) {
        battery_w = walk.number(-2, 2) * 2'000;
        ordered_s = utc_s;
      }
      meter.status = walk.once_in(15) ? Status::kTimeout : Status::kOk;
      meter.grid_w = shown_w(walk, lie, house_w, battery_w, 700);
      outside.status = walk.once_in(20) ? Status::kMalformed : Status::kOk;
      outside.is_set = !walk.once_in(5);
      outside.limit = {.charge_w_max = walk.edge({0, 1'000}, 0),
                       .discharge_w_max = walk.edge({0, 2'000}, 0),
                       .until_utc_s = utc_s + walk.edge({0, 10, 600})};
      BatteryMeasurement battery;
      battery.power_w = battery_w;
      battery.has_grid_power = !walk.once_in(10);
      battery.grid_power_w = meter.grid_w;
      site.observe(utc_s, !walk.once_in(15), battery,
                   {.is_driven = true, .age_s = static_cast<std::int32_t>(utc_s - ordered_s)});
      const std::int64_t asked_s = utc_s + walk.edge({0, 10, s.age_s_max, -s.age_s_max});
      for (const Margin margin : {Margin::kWhole, Margin::kHalf}) {
        see_range(walk, site.range(asked_s, 4'000, margin));
      }
      const SiteReport report = site.report(asked_s);
      walk.see(report.has_grid_power, report.grid_power_w, report.quarter_hour_import_wh,
               report.quarter_hour_battery_wh, report.meter_status, report.limit_status,
               report.house_is_implausible);
      see_trust(walk, report.trust);
    }
    walk.end_line(block);
  }
  walk.hold();
}

}  // namespace
}  // namespace bess
