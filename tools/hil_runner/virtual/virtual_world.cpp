#include "tools/hil_runner/virtual/virtual_world.h"

#include <pthread.h>
#include <signal.h>

#include <functional>
#include <optional>

#include "edge/core/control/policy.h"
#include "edge/prices/fetch/price_fetcher.h"
#include "edge/records/log/record_codec.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/scenario_parts.h"
#include "tools/hil_runner/virtual/virtual_bus.h"
#include "tools/hil_runner/virtual/virtual_time.h"
#include "tools/hil_runner/witness/manufacturer_table.h"

namespace bess {

void VirtualOperator::act(const ScenarioEvent& event, std::int64_t now_utc_s,
                          const std::optional<Trip>& trip) {
  using enum ScenarioEvent::EventKind;
  switch (event.kind) {
    case kHold:
      return holds_.publish({.power_w = event.power_w,
                             .until_utc_s = static_cast<std::uint32_t>(now_utc_s + event.for_s)});
    case kHoldRelease:
      return holds_.publish({});
    case kLimit:
    case kLimitTorn:
      limit_ = limit_line(event, now_utc_s);
      return;
    case kLimitClear:
      limit_.clear();
      return;
    case kClear:
      if (trip) cleared_.add(trip->utc_s);
      return;
    default:
      return;
  }
}

Status VirtualOperator::read(OutsideLimit& limit, bool& is_set) const {
  is_set = false;
  if (limit_.empty()) return Status::kOk;
  const Status status = parse_outside_limit(limit_, limit);
  is_set = status == Status::kOk;
  return status;
}

namespace {

/// Restores the signal mask, because EdgeClock blocks signals that end a program.
class SavedSignalMask {
 public:
  SavedSignalMask() { pthread_sigmask(SIG_SETMASK, nullptr, &mask_); }
  SavedSignalMask(const SavedSignalMask&) = delete;
  SavedSignalMask& operator=(const SavedSignalMask&) = delete;
  ~SavedSignalMask() { pthread_sigmask(SIG_SETMASK, &mask_, nullptr); }

 private:
  sigset_t mask_{};
};

/// Decodes the wire with the manufacturer's table only.
VirtualBus::WireListener wire_decoder(const RegisterMap& map, std::vector<WireReading>& readings) {
  const ManufacturerTable* const table = manufacturer_table(map.name.view(), map.variant.view());
  if (table == nullptr) fail("witness: no manufacturer table for the map \"{}\"", map.name.view());
  return [table, &readings, wire = WireMemory()](
             WireMemory::Frame request, WireMemory::Frame answer, std::int64_t utc_ns) mutable {
    if (!wire.exchanged(request, answer)) return;
    const WireReading reading{.utc_ns = utc_ns,
                              .soc_frac = table->soc_frac(wire),
                              .power_w = table->power_w(wire),
                              .ordered_w = table->ordered_w(wire)};
    if (readings.empty() || !reading.shows_the_same(readings.back())) readings.push_back(reading);
  };
}

/// Runs an edge from start to end; returns its exit code.
int run_edge(const EdgeConfig& config, VirtualWorld& world) {
  Controller<VirtualWorld> controller(config, world);
  if (!controller.reach() || !controller.begin()) return 1;
  constexpr std::int64_t kEndless = -1;
  return controller.run(kEndless) ? 0 : 1;
}

}  // namespace

Evidence run_virtual(const Scenario& scenario, const MinuteSeries& prices, const EdgeConfig& config,
                     PowerDerating derating) {
  const SavedSignalMask mask;
  VirtualTime time(scenario);
  SimulatedBattery battery(scenario.battery.physics, scenario.battery.soc_frac, time.utc_ns());
  std::optional<MeteredHouse> house;
  if (scenario.house.exists()) house.emplace(house_load(scenario));
  VirtualBus bus({.port = config.battery.link.port,
                  .rtu = config.battery.link.rtu,
                  .response_delay_ms = scenario.battery.response_delay_ms,
                  .faults = scenario.battery_faults,
                  .start_utc_ns = scenario.utc_ns_at(0)},
                 config.battery.map, battery, time, house ? &*house : nullptr);
  std::optional<VirtualBus> meter;
  if (scenario.meter.source == ScenarioMeter::Source::kMap) {
    meter.emplace(VirtualBusSettings{.port = config.site.link.port,
                                     .response_delay_ms = scenario.battery.response_delay_ms,
                                     .faults = {scenario.meter.fault},
                                     .start_utc_ns = scenario.utc_ns_at(0)},
                  config.site.map, battery, time, &*house);
  }
  const MarketView market(prices, scenario.prices.latency_s);
  MarketFaultPlan faults(scenario.price_fault);
  Evidence evidence;
  if (scenario.witness) bus.show_to(wire_decoder(config.battery.map, evidence.wire));
  EdgeState state;
  state.reserve(static_cast<std::size_t>(60 * scenario.minutes / kSecondsPerStep) + 2);
  VirtualOperator site_operator;
  std::optional<VirtualOutlook> outlook;
  if (const OutlookModel* const model = student_outlook())
    outlook.emplace(scenario, config.outlook, *model, time);
  time.on_operator([&](const ScenarioEvent& event) {
    if (event.kind == ScenarioEvent::EventKind::kStateLost) {
      if (outlook) outlook->lose();
      return state.lose();
    }
    site_operator.act(event, time.edge_utc_s(), state.trip());
  });
  do {
    try {
      VirtualWorld world(config, VirtualPrices(config.price.feed, market, faults, scenario, time),
                         {.time = time,
                          .physics = battery,
                          .derating = derating,
                          .state = state,
                          .site_operator = site_operator,
                          .outlook = outlook ? &*outlook : nullptr});
      evidence.edge_exit_code = run_edge(config, world);
    } catch (const EdgeKilled&) {
      evidence.edge_exit_code = 128 + SIGKILL;
    }
  } while (time.advance_to_next_start());
  bus.device().advance(time.utc_ns());
  evidence.orders = battery.dispatch_events();
  evidence.minutes = battery.record();
  evidence.sent = bus.sent() ^ (meter ? 31 * meter->sent() : 0);
  evidence.log = state.take_records();
  evidence.is_alive_at_end = true;
  return evidence;
}

void EdgeState::add(const CycleRecord& record) {
  RecordBytes bytes{};
  encode_record(record, records_.size() + 1, bytes);
  std::uint64_t number = 0;
  if (!decode_record(bytes, records_.emplace_back(), number))
    fail("a record of the edge's ring is unreadable");
}

bool EdgeState::read_back(std::int64_t records, CycleRecord& record) const {
  const auto size = std::ssize(records_) - readable_from_;
  if (records >= size) return false;
  record = records_[records_.size() - 1 - static_cast<std::size_t>(records)];
  return true;
}

std::optional<Trip> EdgeState::trip() const {
  if (records_.empty() || is_lost() || !records_.back().is_tripped) return std::nullopt;
  return records_.back().trip;
}

VirtualWorld::VirtualWorld(const EdgeConfig& config, const VirtualPrices& prices,
                           const VirtualEnvironment& environment)
    : environment_(environment),
      price_(config.price),
      clock_(config.clock),
      battery_(config.battery.link, config.battery.map, config.clock),
      meter_(config.site.link, config.site.map, config.clock),
      prices_(prices) {}

RestoredState VirtualWorld::restore_state() const {
  RestoredState restored;
  static_cast<void>(environment_.state.read_back(0, restored.before));
  const std::optional<Trip> trip = environment_.state.trip();
  if (trip && !environment_.site_operator.is_cleared(trip->utc_s)) restored.trip = trip;
  if (!environment_.state.is_lost()) return restored;
  restored.unknown = "the scenario has deleted it";
  restored.trip = trip_without_state(restored, environment_.time.edge_utc_s());
  return restored;
}

PublishedHistory VirtualWorld::find_history() {
  return fetch_history(price_, clock_.scaled(),
                       std::bind_front(&VirtualPrices::fetch_page, &prices_),
                       std::bind_front(&EdgeClock::stop_requested, &clock_));
}

void VirtualWorld::cycle_done(const CycleRecord&) {
  if (environment_.derating == nullptr) return;
  const std::int64_t now_utc_s = environment_.time.utc_ns() / kNanosecondsPerSecond;
  environment_.physics.set_derating(environment_.derating(now_utc_s));
}

}  // namespace bess
