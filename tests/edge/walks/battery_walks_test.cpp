// Walks over edge/battery: frames with a bit gone, devices whose registers change under the driver,
// links that break, batteries under commission.
#include <algorithm>

#include "edge/battery/alive_watch.h"
#include "edge/battery/answer_curve.h"
#include "edge/battery/commission.h"
#include "edge/battery/flash_budget.h"
#include "edge/battery/grid_meter.h"
#include "edge/battery/link_state.h"
#include "edge/battery/meter_proof.h"
#include "edge/battery/modbus_frame.h"
#include "edge/battery/read_plan.h"
#include "edge/battery/unanswered_requests.h"
#include "tests/edge/walks/walk.h"
#include "tests/support/image_device.h"

namespace bess {
namespace {

ModbusRequest drawn_request(Walk& walk, const std::uint16_t* values) {
  ModbusRequest request;
  request.unit = walk.once_in(20) ? walk.edge({0, 255}) : 1;
  request.function = static_cast<std::uint8_t>(walk.one_of({3, 3, 4, 6, 16, 16, 5}));
  request.address = static_cast<std::uint16_t>(walk.once_in(20) ? 0xFFFF - walk.from(0, 130)
                                                                : walk.from(0, 50'000));
  request.count = walk.once_in(9) ? walk.edge({0, 1, 123, 125}) : walk.number(1, 5);
  if (request.function == 6 && !walk.once_in(20)) request.count = 1;
  request.values = values;
  request.transaction = static_cast<std::uint16_t>(walk.from(0, 0xFFFF));
  return request;
}

/// The reply of an honest device, by the same words as the request (TCP) or with its sum made by
/// building a request of the same bytes (RTU).
ModbusFrame honest_reply(Walk& walk, Framing framing, const ModbusRequest& request) {
  ModbusFrame body;
  body.bytes[body.size++] = static_cast<std::uint8_t>(request.unit);
  if (walk.once_in(5)) {
    body.bytes[body.size++] = static_cast<std::uint8_t>(request.function | 0x80);
    body.bytes[body.size++] = static_cast<std::uint8_t>(walk.one_of({1, 2, 4, 5, 6, 0x80}));
  } else if (request.is_write()) {
    const int echoed = request.function == 6 ? request.values[0] : request.count;
    for (const int word : {0x100 * request.function + (request.address >> 8),
                           ((request.address & 0xFF) << 8) + (echoed >> 8)}) {
      body.bytes[body.size++] = static_cast<std::uint8_t>(word >> 8);
      body.bytes[body.size++] = static_cast<std::uint8_t>(word & 0xFF);
    }
    body.bytes[body.size++] = static_cast<std::uint8_t>(echoed & 0xFF);
  } else {
    body.bytes[body.size++] = request.function;
    body.bytes[body.size++] = static_cast<std::uint8_t>(2 * request.count);
    for (int i = 0; i < 2 * request.count; ++i) {
      body.bytes[body.size++] = static_cast<std::uint8_t>(walk.from(0, 255));
    }
  }
  ModbusFrame frame;
  if (framing == Framing::kTcp) {
    for (const int byte : {request.transaction >> 8, request.transaction & 0xFF, 0, 0,
                           body.size >> 8, body.size & 0xFF}) {
      frame.bytes[frame.size++] = static_cast<std::uint8_t>(byte);
    }
  }
  std::copy_n(body.bytes, body.size, frame.bytes + frame.size);
  frame.size += body.size;
  if (framing == Framing::kRtu) {
    unsigned sum = 0xFFFF;  // Modbus over serial line V1.02, 6.2.2
    for (int i = 0; i < frame.size; ++i) {
      sum ^= frame.bytes[i];
      for (int bit = 0; bit < 8; ++bit) sum = (sum & 1) != 0 ? sum >> 1 ^ 0xA001 : sum >> 1;
    }
    frame.bytes[frame.size++] = static_cast<std::uint8_t>(sum & 0xFF);
    frame.bytes[frame.size++] = static_cast<std::uint8_t>(sum >> 8);
  }
  return frame;
}

TEST(BatteryWalk, Frames) {
  Walk walk("frames");
  for (int block = 0; block < 20; ++block) {
    const Framing framing = block % 2 == 0 ? Framing::kTcp : Framing::kRtu;
    for (int i = 0; i < 1'500; ++i) {
      std::uint16_t values[130];
      for (std::uint16_t& v : values) v = static_cast<std::uint16_t>(walk.from(0, 0xFFFF));
      const ModbusRequest request = drawn_request(walk, values);
      walk.see(request.is_valid());
      if (!request.is_valid()) continue;
      ModbusFrame frame;
      build_request(framing, request, frame);
      for (int b = 0; b < frame.size; ++b) walk.see(frame.bytes[b]);
      ModbusFrame reply = honest_reply(walk, framing, request);
      if (walk.once_in(2))
        reply.bytes[walk.from(0, std::min(reply.size, 9) - 1)] ^=
            static_cast<std::uint8_t>(1 << walk.from(0, 7));
      if (walk.once_in(6)) reply.size = walk.number(0, reply.size);
      if (walk.once_in(12)) reply.size = std::min(reply.size + walk.number(1, 2), kFrameBytesMax);
      if (framing == Framing::kTcp && walk.once_in(12)) {
        reply.bytes[5] = static_cast<std::uint8_t>(walk.edge({2, 3, 254}));
      }
      std::uint16_t registers[kReadRegistersMax] = {};
      walk.see(missing_bytes(framing, request, reply), reply_bytes_max(framing, request));
      const ReplyCheck check = check_reply(framing, request, reply, registers);
      walk.see(check.status, check.exception);
      for (const std::uint16_t r : registers) walk.see(r);
    }
    walk.end_line(block);
  }
  for (int code = 0; code < 256; ++code) walk.see(status_of_exception(code));
  walk.end_line("exceptions");
  walk.hold();
}

TEST(BatteryWalk, Links) {
  Walk walk("links");
  for (int block = 0; block < 20; ++block) {
    LinkStateMachine link({.back_off_first_ns = 10,
                           .back_off_max_ns = walk.one_of({60, 80}),
                           .connect_delay_ns = walk.from(0, 5),
                           .gap_ns = walk.from(0, 4),
                           .quiet_ns = walk.from(0, 9)});
    UnansweredRequests unanswered(walk.from(5, 20));
    FlashBudget budget({.eeprom_writes_per_day = block % 4 * 5, .reserve = block % 3});
    std::int64_t now_ns = 0, day = 100;
    for (int i = 0; i < 800; ++i) {
      now_ns += walk.from(0, 12);
      switch (walk.from(0, 5)) {
        case 0:
          link.on_connected(now_ns);
          break;
        case 1:
          link.on_connect_failed(now_ns);
          break;
        case 2:
          link.on_answered(now_ns);
          break;
        case 3:
          link.on_no_answer(now_ns);
          break;
        case 4:
          link.on_drained();
          break;
        default:
          link.on_lost(now_ns);
          break;
      }
      walk.see(link.state(now_ns), link.state(now_ns + walk.from(8, 82)), link.ready_ns());
      ModbusRequest request;
      request.unit = walk.number(1, 2);
      request.function = static_cast<std::uint8_t>(walk.from(3, 4));
      request.address = static_cast<std::uint16_t>(walk.from(1, 3));
      request.count = walk.number(1, 2);
      walk.see(unanswered.earliest_ns(request), unanswered.empty());
      if (walk.once_in(2)) unanswered.add(request, now_ns);
      if (walk.once_in(4)) unanswered.on_answered(request, now_ns);
      if (walk.once_in(4)) unanswered.forget_old(now_ns + walk.edge({0, 10}));
      if (walk.once_in(30)) day += walk.from(-1, 1);
      const std::int32_t writes = walk.number(0, 5);
      walk.see(budget.allows(day, writes), budget.is_spent(day), budget.writes_on(day));
      if (walk.once_in(2)) budget.count(day);
      if (walk.once_in(40)) budget.restore(day - walk.from(0, 1), walk.number(0, 16));
    }
    walk.end_line(block);
  }
  walk.hold();
}

TEST(BatteryWalk, ReadPlans) {
  Walk walk("read_plans");
  for (int i = 0; i < 1'500; ++i) {
    RegisterMap map;
    map.read_gap_registers_max = walk.number(0, 6);
    map.registers_per_read_max = walk.edge({5, 20, 120, 125});
    PlacedPoints points, missing;
    const int count = walk.number(1, 20);
    const auto drawn_place = [&walk] {
      return RegisterSpan{.unit = walk.number(1, 2),
                          .address = static_cast<std::uint16_t>(walk.from(0, 130)),
                          .count = static_cast<std::uint16_t>(walk.from(1, 4)),
                          .function = static_cast<std::uint8_t>(walk.once_in(5) ? 4 : 3)};
    };
    for (int p = 0; p < count; ++p) points.push_back({drawn_place(), static_cast<std::int8_t>(p)});
    for (int p = walk.number(-2, 2); p > 0; --p) missing.push_back({drawn_place(), 1});
    ReadPlan plan;
    plan_reads(map, points, missing, plan);
    for (const RegisterSpan& span : plan) {
      walk.see(span.unit, span.address, span.count, span.function);
      for (const PlacedPoint& point : points) walk.see(offset_in(span, point));
    }
    if (i % 150 == 149) walk.end_line(i);
  }
  walk.hold();
}

/// A device as its map describes it, at rest; registers then change by the walk alone.
struct WalkedDevice {
  SimulatedDevice d;
  std::vector<int> addresses;  ///< of the holding table, where something stands or was written

  WalkedDevice(const MapVariant& variant) : d(variant.map, variant.variant) {
    d.image.refresh(d.utc_ns());
    d.test.device.before_request = [] {};
    d.test.device.after_write = [](int, int) {};
    for (int a = 0; a < 0x1'0000; ++a) {
      if (d.test.device.holding[static_cast<std::size_t>(a)] != 0) addresses.push_back(a);
    }
    for (const RegisterPoint& p : d.test.map.points) {
      if (p.model < 0) addresses.push_back(p.address);
    }
  }

  void poke(Walk& walk) {
    auto& table = walk.once_in(3) ? d.test.device.input : d.test.device.holding;
    const int at = addresses[static_cast<std::size_t>(walk.from(0, std::ssize(addresses) - 1))];
    std::uint16_t& raw = table[static_cast<std::size_t>(at)];
    raw = static_cast<std::uint16_t>(
        walk.once_in(2) ? raw + walk.from(-2, 2)
                        : walk.one_of({0, 1, 2, 0xFFFF, 0x8000, 0x7FFF, 50, 500, 5'000, 240}));
  }

  void see(Walk& walk) {
    RegisterDevice& device = d.test.device;
    for (const WriteRecord& w : device.take_writes()) {
      walk.see(w.unit, w.function, w.address);
      for (const int value : w.values) walk.see(value);
      addresses.push_back(w.address);
    }
    if (addresses.size() > 400) addresses.resize(300);
    walk.see(device.reads, device.now_ns, device.refused_reads);
    const BatteryCounters c = d.test.driver->counters();
    walk.see(c.requests, c.failed_requests, c.reconnects, c.register_writes, c.unchanged_orders,
             c.flash_day, c.flash_writes_today);
  }
};

void see_measurement(Walk& walk, const BatteryMeasurement& m) {
  walk.see(m.soc_e4, m.power_w, m.capacity_wh, m.charge_w_max, m.discharge_w_max,
           m.temperature_min_deci_c, m.temperature_max_deci_c, m.alarm, m.off_grid,
           m.dispatch_active, m.has_order_power, m.order_power_w, m.order_replaced, m.order_ended,
           m.has_grid_power, m.grid_power_w, m.warning);
}

void draw_trouble(Walk& walk, RegisterDevice& device) {
  device.exception = walk.once_in(25) ? walk.edge({0, 2, 6, 0x80}) : 0;
  if (walk.once_in(40)) device.failing_writes = walk.number(1, 2);
  device.ignores_writes = walk.once_in(30);
  if (walk.once_in(60)) ++device.reconnects;
  if (walk.once_in(60)) ++device.day;
  device.pass_s(static_cast<double>(
      walk.one_of({0, 1, 5, 30, 59, 60, 61, 119, 120, 120, 120, 180, 240, 300, 600})));
}

TEST(BatteryWalk, Driver) {
  Walk walk("driver");
  for (const MapVariant& variant : kShippedMapVariants) {
    for (int run = 0; run < 6; ++run) {
      WalkedDevice walked(variant);
      MapUnderTest& test = walked.d.test;
      if (run % 3 == 2) test.driver->restore_flash_writes(test.device.day, walk.number(0, 200));
      if (run == 5) test.device.missing.push_back({3, walked.addresses[0], 2});
      for (int i = 0; i < 220; ++i) {
        if (run > 0) draw_trouble(walk, test.device);
        if (run > 0 && walk.once_in(6)) walked.poke(walk);
        if (run == 0) test.device.pass_s(60);
        switch (walk.from(0, 11)) {
          case 0:
          case 1:
          case 2:
          case 3: {
            PowerOrder order{.power_w = walk.edge({0, 1'000, -1'000, 4'000, -4'000}, 0),
                             .soc_min_e4 = 1'000,
                             .soc_max_e4 = 9'000,
                             .duration_s = test.map.watchdog.duration_s};
            if (walk.once_in(40)) order.power_w = walk.edge({test.map.charge_w_max});
            if (walk.once_in(30)) order.write_until_ns = test.device.now_ns + walk.from(-1, 1);
            if (walk.once_in(30)) order.feed_until_ns = test.device.now_ns + walk.from(-1, 1);
            walk.see(test.driver->order(order));
            break;
          }
          case 4:
          case 5:
            walk.see(test.driver->refresh());
            break;
          case 6:
            walk.see(test.driver->release());
            break;
          case 7:
            if (walk.once_in(20)) test.driver->permit_release();
            if (walk.once_in(9)) {
              IdentityFailure failure;
              walk.see(test.driver->check_identity(failure), failure.check, failure.value);
            }
            break;
          default:
            walk.see(test.read());
            see_measurement(walk, test.measured);
            break;
        }
        walked.see(walk);
      }
      walk.see(test.driver->refresh_interval_s());
      walk.end_line(std::string(variant.map) + " " + variant.variant + " " + std::to_string(run));
    }
  }
  walk.hold();
}

constexpr const char* kWalkedMeters[] = {"eastron_sdm630", "sunspec",       "victron_gx",
                                         "simulator",      "p1_dongle_pro", "fronius_smart_meter"};

TEST(BatteryWalk, GridMeters) {
  Walk walk("grid_meters");
  for (const char* name : kWalkedMeters) {
    RegisterMap map;
    std::string error;
    ASSERT_TRUE(load_register_map(std::string(BESS_SOURCE_DIR) + "/edge/meters/" + name + ".toml",
                                  "", map, error))
        << error;
    for (int run = 0; run < 4; ++run) {
      RegisterDevice device;
      for (const IdentityCheck& check : map.identity) {
        const RegisterPoint& p = map.points[check.point];
        RegisterBlock block;
        if (p.model >= 0 || encode(p, check.value_min, Rounding::kNearest, block) != Status::kOk) {
          continue;
        }
        for (int r = 0; r < block.size(); ++r) {
          device.holding[static_cast<std::size_t>(p.address + r)] = block[r];
          device.input[static_cast<std::size_t>(p.address + r)] = block[r];
        }
      }
      GridMeter<DeviceLink, DeviceClock> meter(map, DeviceClock(device), -1, device);
      for (int i = 0; i < 150; ++i) {
        for (const RegisterPoint& p : map.points) {
          if (!walk.once_in(3) || run == 0) continue;
          const auto at = static_cast<std::size_t>(p.address + walk.from(0, p.registers - 1));
          device.holding[at] = device.input[at] = static_cast<std::uint16_t>(
              walk.one_of({0, 1, 500, 0x4120, 0xC120, 0x43FA, 0xFFFF, 0x8000}));
        }
        if (run > 1) draw_trouble(walk, device);
        device.pass_s(10);
        std::int32_t grid_w = 0;
        walk.see(meter.read(grid_w), grid_w, device.reads, device.now_ns);
      }
      walk.end_line(std::string(name) + " " + std::to_string(run));
    }
  }
  walk.hold();
}

TEST(BatteryWalk, AnswerCurvesAndMeterProofs) {
  Walk walk("answer_curves");
  for (int i = 0; i < 2'000; ++i) {
    const std::int32_t ordered_w = walk.one_of({1, 500, 1'000}) != 1 ? 500 : 1'000;
    AnswerCurve curve(ordered_w, walk.number(0, 2) * 75);
    MeterProof proof;
    std::int64_t ms = 0;
    const int shape = walk.number(0, 3);
    const int count = walk.once_in(100) ? 300 : walk.number(0, 20);
    std::int32_t battery_w = 0;
    for (int r = 0; r < count; ++r) {
      ms += walk.from(500, 1'200);
      const std::int32_t along_w = shape == 0   ? ordered_w
                                   : shape == 1 ? std::min(ordered_w, 40 * r)
                                   : shape == 2
                                       ? (r < 5 ? 0 : ordered_w + walk.number(-80, 80))
                                       : walk.edge({0, ordered_w / 10, ordered_w * 9 / 10,
                                                    ordered_w, ordered_w - 75, ordered_w + 75});
      curve.add({.begin_ms = ms, .end_ms = ms + walk.from(0, 300), .along_w = along_w});
      if (r % 5 == 0) battery_w = walk.edge({0, 500, -500}, 0);
      const std::int32_t step_w = battery_w / 5 + 50;
      proof.add(battery_w, walk.once_in(3) ? battery_w + walk.edge({step_w, -step_w})
                           : shape == 0    ? -battery_w
                                           : battery_w + 300);
      if (r % 5 == 4) proof.end_plateau();
    }
    walk.see(curve.outside_until_ms(), curve.has_come(), curve.came_ms(), curve.is_rising(),
             curve.readings_outside_after(3'000), proof.verdict(), proof.percent());
    if (i % 200 == 199) walk.end_line(i);
  }
  walk.hold();
}

struct WalkedClockOfBattery {
  std::int64_t now_ns = 1'000'000'000'000;
  std::int64_t stop_ns = INT64_MAX;
  [[nodiscard]] std::int64_t now_utc_ns() const { return now_ns; }
  bool sleep_until_utc_ns(std::int64_t utc_ns) {
    now_ns = std::max(now_ns, utc_ns);
    return now_ns < stop_ns;
  }
  void pause_ns(std::int64_t ns) { now_ns += ns; }
};

/// Follows as its numbers say, in integers.
struct CommissionedBattery {
  WalkedClockOfBattery& clock;
  Walk& walk;
  BatteryMeasurement shown{.soc_e4 = 5'000, .capacity_wh = 8'000};
  std::int32_t percent = 100, offset_w = 0, ramp_w_per_s = 10'000, lag_s = 0, refresh_s = 0;
  std::uint64_t failing = 0;
  std::int64_t ordered_ns = 0;
  std::int32_t ordered_w = 0, from_w = 0;
  int refreshes = 0, releases = 0, failing_releases = 0;
  std::int64_t alarm_ns = INT64_MAX;

  [[nodiscard]] std::int32_t power_w() const {
    const std::int64_t since_ms = (clock.now_ns - ordered_ns) / 1'000'000 - lag_s * 1'000;
    if (since_ms < 0) return from_w + offset_w;
    const std::int32_t aim_w = ordered_w * percent / 100;
    const std::int64_t moved_w = std::min<std::int64_t>(ramp_w_per_s * since_ms / 1'000, 100'000);
    const std::int64_t left_w = aim_w - from_w;
    const std::int64_t step_w = left_w < 0 ? std::max(left_w, -moved_w) : std::min(left_w, moved_w);
    return static_cast<std::int32_t>(from_w + step_w) + offset_w;
  }
  Status read(BatteryMeasurement& m) {
    clock.now_ns += 50'000'000;
    if (failing > 0 && walk.once_in(failing)) return Status::kTimeout;
    m = shown;
    m.power_w = power_w();
    m.alarm = shown.alarm || clock.now_ns > alarm_ns;
    return Status::kOk;
  }
  Status order(const PowerOrder& o) {
    walk.see(o.power_w, o.soc_min_e4, o.soc_max_e4, o.duration_s);
    from_w = power_w() - offset_w;
    ordered_w = o.power_w;
    ordered_ns = clock.now_ns;
    return failing > 0 && walk.once_in(failing) ? Status::kNotApplied : Status::kOk;
  }
  [[nodiscard]] std::int32_t refresh_interval_s() const { return refresh_s; }
  Status refresh() {
    ++refreshes;
    return Status::kOk;
  }
  Status release() {
    ++releases;
    return failing_releases-- > 0 ? Status::kTimeout : Status::kOk;
  }
};

struct CommissionedMeter {
  Walk* walk = nullptr;
  bool is_there = false;
  int lie = 0;
  std::uint64_t restless = 0;
  std::int32_t house_w = 400;
  [[nodiscard]] bool exists() const { return is_there; }
  Status read(const BatteryMeasurement& m, std::int32_t& grid_w) {
    if (restless > 0 && walk->once_in(restless)) house_w = walk->number(0, 900);
    if (lie == 3 && walk->once_in(60)) return Status::kTimeout;
    grid_w = house_w + (lie == 1 ? -m.power_w : lie == 2 ? m.power_w * 8 / 10 : m.power_w);
    return Status::kOk;
  }
};

void see_direction(Walk& walk, const DirectionResult& d) {
  const AnswerSpeed& s = d.speed;
  walk.see(d.is_tested, d.ordered_power_w, d.measured_power_w, d.came_ms, d.further_w,
           d.further_measured_w, d.is_held_back, s.has_two, s.is_slow, s.is_doubtful);
}

TEST(BatteryWalk, Commission) {
  Walk walk("commission");
  for (int i = 0; i < 900; ++i) {
    WalkedClockOfBattery clock;
    CommissionedBattery battery{.clock = clock, .walk = walk};
    CommissionSettings s;
    s.rest_s = walk.number(2, 12);
    s.drive_s = walk.number(10, 30);
    s.response.settle_s = static_cast<std::int32_t>(walk.one_of({5, 10, 20, 25}));
    s.step_w_max = static_cast<std::int32_t>(walk.one_of({500, 8'000}));
    s.noise_w = 150;
    if (walk.once_in(3)) {
      battery.percent = walk.edge({100, 50, 85, 115, -50, -100, 0, 84, 116, 30, 200, 65, 135}, 1);
    }
    if (walk.once_in(3)) battery.offset_w = walk.edge({150, -150, 0, 75});
    if (walk.once_in(3)) {
      battery.ramp_w_per_s = static_cast<std::int32_t>(walk.one_of({5, 20, 40, 100, 400}));
    }
    if (walk.once_in(4)) battery.lag_s = walk.number(1, 20);
    if (walk.once_in(3)) battery.refresh_s = walk.number(1, 9);
    if (walk.once_in(9)) battery.failing = static_cast<std::uint64_t>(walk.number(5, 90));
    if (walk.once_in(9)) battery.failing_releases = walk.number(1, 20);
    if (walk.once_in(20)) clock.stop_ns = clock.now_ns + walk.from(1, 90) * 1'000'000'000;
    if (walk.once_in(20)) battery.alarm_ns = clock.now_ns + walk.from(1, 90) * 1'000'000'000;
    BatteryMeasurement& m = battery.shown;
    if (walk.once_in(4)) m.soc_e4 = walk.edge({1'100, 9'900, 5'500, 1'000, 10'000});
    if (walk.once_in(9)) m.charge_w_max = walk.edge({500});
    if (walk.once_in(9)) m.discharge_w_max = walk.edge({500});
    if (walk.once_in(40)) m.alarm = true;
    if (walk.once_in(40)) m.off_grid = true;
    if (walk.once_in(40)) m.dispatch_active = true;
    CommissionedMeter meter{.walk = &walk, .is_there = walk.once_in(2), .lie = walk.number(0, 4)};
    if (walk.once_in(4)) meter.restless = static_cast<std::uint64_t>(walk.number(3, 30));
    SignCheck<CommissionedBattery, WalkedClockOfBattery, CommissionedMeter> check(s, battery, clock,
                                                                                  meter);
    const CommissionResult r = check.run();
    walk.see(r.verdict, r.status, r.release_status, r.soc_e4, r.ordered_power_w, r.measured_power_w,
             r.meter, r.meter_percent, r.rest_house_w, r.wanted_settle_s, r.wanted_tolerance_w,
             r.wanted_ramp_w_max, battery.refreshes, battery.releases, clock.now_ns);
    walk.see_text(commission_text(r.verdict));
    see_direction(walk, r.charge);
    see_direction(walk, r.discharge);
    if (i % 30 == 29) walk.end_line(i);
  }
  walk.hold();
}

}  // namespace
}  // namespace bess
