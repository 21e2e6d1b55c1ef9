#include "tools/hil_runner/wall/wall_run.h"

#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <thread>
#include <vector>

#include "edge/app/storage/commission_file.h"
#include "edge/device/battery/commission.h"
#include "shared/host/file.h"
#include "shared/host/pty_bridge.h"
#include "shared/scaled_clock.h"
#include "tools/hil_runner/base/stop_request.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/publication.h"
#include "tools/hil_runner/scenario/scenario_parts.h"
#include "tools/hil_runner/wall/edge_process.h"
#include "tools/simulators/battery_sim/battery_record.h"
#include "tools/simulators/site/site_programs.h"

namespace bess {

namespace {

/// Builder of a command line.
struct Options {
  std::vector<std::string> words{};

  template <typename Value>
  void add(const std::string& name, const Value& value) {
    words.insert(words.end(), {name, fmt::format("{}", value)});
  }
  /// Without --to-s: until the end.
  void add_span(const std::string& prefix, double from_s, double to_s) {
    add(prefix + "-from-s", from_s);
    if (to_s != kNeverMin) add(prefix + "-to-s", to_s);
  }
  /// Faults, their span, and on-off times.
  void add_faults(const std::string& prefix, const FaultSchedule& schedule) {
    for (const BatteryFault kind : schedule.faults) {
      add(prefix, battery_fault_name(kind));
    }
    add_span(prefix, schedule.from_s, schedule.to_s);
    if (schedule.off_s == 0) return;
    add(prefix + "-on-s", schedule.on_s);
    add(prefix + "-off-s", schedule.off_s);
  }
};

void add_plant(Options& options, const ScenarioBattery& battery) {
  options.add("--map", battery.map);
  if (!battery.variant.empty()) options.add("--variant", battery.variant);
  options.add("--soc", battery.soc_frac);
  options.add("--power-w", battery.physics.power_w_max);
  options.add("--capacity-wh", battery.physics.capacity_wh);
  options.add("--soc-min", battery.physics.soc_min_frac);
  options.add("--soc-max", battery.physics.soc_max_frac);
}

void add_battery_faults(Options& options, const FaultSchedule& fault) {
  if (fault.faults.empty()) return;
  options.add_faults("--fault", fault);
  if (fault.probability > 0) {
    options.add("--fault-probability", fault.probability);
  } else {
    options.add("--fault-every", fault.every);
  }
  options.add("--fault-seed", fault.seed);
  options.add("--fault-period-s", fault.period_s);
  options.add("--late-ms", fault.late_ms);
  options.add("--drip-ms", fault.drip_ms);
  options.add("--exception-code", fault.exception_code);
}

void add_house(Options& options, const Scenario& scenario, const WorkFolder& folder) {
  if (!scenario.house.exists()) return;
  if (scenario.house.seed) {
    options.add("--house", "daily");
    return options.add("--house-seed", *scenario.house.seed);
  }
  write_file(folder.file("house.csv"), house_csv(scenario));
  options.add("--house", folder.file("house.csv"));
}

void add_meter(Options& options, const ScenarioMeter& meter) {
  if (meter.source != ScenarioMeter::Source::kMap) return;
  options.add("--meter-map", meter.map);
  if (!meter.variant.empty()) options.add("--meter-variant", meter.variant);
  options.add("--meter-port", 0);
  if (!meter.fault.faults.empty()) {
    options.add_faults("--meter-fault", meter.fault);
  }
}

void add_day_ahead(Options& options, const Scenario& scenario, const WorkFolder& folder) {
  if (!scenario.day_ahead) return;
  write_file(folder.file("day_ahead.csv"), day_ahead_csv(scenario));
  options.add("--day-ahead", folder.file("day_ahead.csv"));
  const AuctionSettings& auction = *scenario.day_ahead;
  if (auction.fault == AuctionFault::kNone) return;
  options.add("--day-ahead-fault", kAuctionFaultNames[static_cast<int>(auction.fault)]);
  options.add("--day-ahead-fault-every", auction.every);
  options.add_span("--day-ahead-fault", auction.from_s, auction.to_s);
  if (auction.repair_s) options.add("--day-ahead-repair-s", *auction.repair_s);
}

/// `serial_device`: end of the line for the battery; empty: TCP. Writes a file for a house with
/// steps.
std::vector<std::string> battery_options(const Scenario& scenario, const std::string& serial_device,
                                         const WorkFolder& folder) {
  Options options;
  add_plant(options, scenario.battery);
  if (!serial_device.empty()) {
    options.add("--serial", serial_device);
    options.add("--baud", 115'200);
  }
  for (const FaultSchedule& fault : scenario.battery_faults) {
    add_battery_faults(options, fault);  // only one: the reader refuses more
  }
  add_house(options, scenario, folder);
  add_meter(options, scenario.meter);
  return options.words;
}

/// `prices`: minute file. Writes a file for day-ahead prices.
std::vector<std::string> market_options(const Scenario& scenario, const std::string& prices,
                                        const WorkFolder& folder) {
  const MarketFaultSchedule& fault = scenario.price_fault;
  Options options;
  options.add("--prices", prices);
  options.add("--latency-s", scenario.prices.latency_s);
  add_day_ahead(options, scenario, folder);
  if (fault.fault == MarketFault::kNone) return options.words;
  options.add("--fault", kMarketFaultNames[static_cast<int>(fault.fault)]);
  options.add("--fault-every", fault.every);
  options.add_span("--fault", fault.from_s, fault.to_s);
  return options.words;
}

/// Worst wake-up latency of this machine during the life of this object.
class Lateness {
 public:
  Lateness() : thread_([this] { run(); }) {}
  Lateness(const Lateness&) = delete;
  Lateness& operator=(const Lateness&) = delete;
  ~Lateness() {
    is_ending_ = true;
    thread_.join();
  }
  [[nodiscard]] double worst_s() const { return static_cast<double>(worst_ns_) / 1e9; }

 private:
  void run() {
    constexpr std::int64_t kTickNs = 5'000'000;
    while (!is_ending_) {
      const std::int64_t due_ns = clock_ns(CLOCK_MONOTONIC) + kTickNs;
      while (clock_ns(CLOCK_MONOTONIC) < due_ns) sleep_until_monotonic(due_ns);
      worst_ns_ = std::max(worst_ns_.load(), clock_ns(CLOCK_MONOTONIC) - due_ns);
    }
  }

  std::atomic<std::int64_t> worst_ns_ = 0;
  std::atomic<bool> is_ending_ = false;
  std::thread thread_;
};

/// Real battery in a run: commissioned first, checked every second, and released at every end.
class RealDeviceRun {
 public:
  /// All must outlive this object.
  RealDeviceRun(const Scenario& scenario, const RealBattery& battery, const WorkFolder& folder,
                EdgeProcess& edge)
      : scenario_(scenario), battery_(battery), folder_(folder), edge_(edge) {}

  /// Commissioning by the edge: half a minute of a small order.
  void commission() {
    constexpr useconds_t kLookUs = 50'000;
    edge_.start_command({"commission", "--yes"});
    while (edge_.runs()) {
      check_stop_request();
      usleep(kLookUs);
    }
    if (edge_.wait() != 0) fail("{}", edge_.last_line());
  }
  /// Throws Interrupted on a stop request, UserError beyond the limits.
  void look() {
    check_stop_request();
    const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
    CycleRecord cycle;
    if (now_ns < next_look_ns_) return;
    next_look_ns_ = now_ns + kNanosecondsPerSecond;
    if (!edge_.newest(cycle)) return;
    show(cycle);
    const std::string broken = beyond_limits(cycle, battery_);
    if (!broken.empty()) fail("stopped: {} exceeds the limits of --real", broken);
  }
  /// File for the bus traffic of the next edge.
  [[nodiscard]] std::string next_recording() {
    recordings_.push_back(folder_.file(fmt::format("bus-{}.jsonl", recordings_.size() + 1)));
    return recordings_.back();
  }
  [[nodiscard]] bool has_begun() const { return edge_.is_started() || !recordings_.empty(); }
  /// Stops the edge, which releases the battery; if not, releases it by a command and reports.
  void give_back() {
    edge_.end(SIGTERM);
    CycleRecord last;
    if (edge_.newest(last) && last.mode == Mode::kStopping && last.battery_status == Status::kOk) {
      return fmt::print(stderr, "{}: mode=stopping battery=ok\n", scenario_.name);
    }
    edge_.start_command({"release", "--yes"});
    const int code = edge_.wait();
    fmt::print(stderr, "{}: {}\n", scenario_.name, edge_.last_line());
    if (code != 0) fmt::print(stderr, "{}: NOT RELEASED, check the battery\n", scenario_.name);
  }
  /// Adds orders from its bus traffic, and its measurements.
  void report_to(Evidence& evidence) const {
    evidence.orders =
        orders_on_the_bus(recordings_, edge_.config().battery.map, scenario_.end_utc_ns());
    evidence.minutes = measured_minutes(evidence.log);
  }

 private:
  void check_stop_request() const {
    if (key_.is_pressed()) request_stop();
    throw_if_stopped();
  }
  void show(const CycleRecord& cycle) const {
    if (isatty(STDERR_FILENO) == 0) return;
    fmt::print(stderr,
               "\r{}: minute {} of {:.0f}, {} W ordered, {} W measured, SoC {:.1f} %; Q stops  ",
               scenario_.name, (cycle.utc_s - scenario_.start_utc_s) / 60, scenario_.minutes,
               cycle.ordered_power_w, cycle.measurement.power_w, cycle.measurement.soc_e4 / 100.0);
  }

  const Scenario& scenario_;
  const RealBattery& battery_;
  const WorkFolder& folder_;
  EdgeProcess& edge_;
  AbortKey key_;
  std::vector<std::string> recordings_;
  std::int64_t next_look_ns_ = 0;
};

constexpr double kStartUpS = 1.2;  ///< wall time until all processes run

bool fills_a_disk(const Scenario& scenario) {
  return std::ranges::any_of(scenario.events, [](const ScenarioEvent& event) {
    return event.kind == ScenarioEvent::EventKind::kDiskFull;
  });
}

std::string seconds_text(const ScenarioEvent& event) { return std::to_string(event.for_s) + "s"; }

/// Tolerance for the wake-up latency of this machine, simulated s. Throws HostTooSlow if orders
/// could overlap with the next control cycle.
double slack_s(const Lateness& lateness, std::int32_t time_scale) {
  constexpr double kLateS = 0.15;  // wall time of an order
  constexpr double kLateFactor = 2;
  constexpr double kSlackMaxS = 60;
  const double slack_s = 2 + (kLateS + kLateFactor * lateness.worst_s()) * time_scale;
  if (slack_s <= kSlackMaxS) return slack_s;
  throw HostTooSlow(
      fmt::format("{} by {:.2f} s, which is too much at time scale {}; use fewer --jobs "
                  "or a smaller time_scale",
                  kTooLate, lateness.worst_s(), time_scale));
}

class WallRun {
 public:
  WallRun(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
          const WorkFolder& folder)
      : scenario_(scenario),
        prices_(prices),
        folder_(folder),
        programs_(site.simulators, folder.file("")),
        edge_(site.edge, folder) {
    if (fills_a_disk(scenario)) disk_.emplace(folder.file("state"));
    if (site.battery) {
      real_run_.emplace(scenario, *site.battery, folder, edge_);
      battery_link_ = link_keys(*site.battery);
    }
  }

  Evidence run() {
    write_minute_file(folder_.file("minutes.csv"), prices_, "");
    programs_.clock = {.anchor_utc_s = scenario_.start_utc_s, .scale = scenario_.time_scale};
    programs_.start_clock(kStartUpS);
    if (real_run_) return run_on_real_battery();
    if (scenario_.battery.rtu) line_.emplace();
    programs_.start_battery(battery_options(scenario_, line_ ? line_->device(0) : "", folder_));
    return run_edge();
  }

 private:
  Evidence run_on_real_battery() {
    try {
      edge_.set_up(scenario_, settings());
      real_run_->commission();
      programs_.start_clock(kStartUpS);
      return run_edge();
    } catch (...) {
      if (real_run_->has_begun()) real_run_->give_back();
      throw;
    }
  }

  Evidence run_edge() {
    start_market();
    edge_.set_up(scenario_, settings());
    if (!real_run_) pretend_commissioned();
    start_edge();
    for (const ScenarioEvent& event : scenario_.events) {
      sleep_until_minute(event.at_min);
      apply(event);
    }
    sleep_until_minute(scenario_.minutes);
    return end();
  }

  [[nodiscard]] std::string settings() const {
    return edge_settings(scenario_, prices_,
                         {.battery_port = programs_.battery_port,
                          .serial_device = line_ ? line_->device(1) : "",
                          .battery_link = battery_link_,
                          .market_port = programs_.market_port,
                          .meter_port = programs_.meter_port,
                          .clock = programs_.clock});
  }

  /// The sign of a simulated battery needs no test.
  void pretend_commissioned() const {
    std::string error;
    const CommissionResult passed{.verdict = CommissionVerdict::kPassed};
    if (!write_commission_file(edge_.config(), passed, scenario_.start_utc_s, error)) {
      throw UserError(error);
    }
  }

  /// A restarted market gets its previous port.
  void start_market() {
    std::vector<std::string> options =
        market_options(scenario_, folder_.file("minutes.csv"), folder_);
    if (programs_.market) {
      options.insert(options.end(), {"--port", std::to_string(programs_.market_port)});
    }
    programs_.start_market(options);
  }
  void start_edge() { edge_.start(real_run_ ? real_run_->next_recording() : ""); }

  void sleep_until_minute(double minute) {
    constexpr std::int64_t kLookNs = 50'000'000;
    const auto wall_ns = static_cast<std::int64_t>(minute * 60e9 / scenario_.time_scale);
    const std::int64_t until_ns = programs_.clock.anchor_monotonic_ns + wall_ns;
    for (std::int64_t now_ns = 0; (now_ns = clock_ns(CLOCK_MONOTONIC)) < until_ns;) {
      real_run_ ? real_run_->look() : throw_if_stopped();
      sleep_until_monotonic(std::min(until_ns, now_ns + kLookNs));
    }
  }

  void apply(const ScenarioEvent& event) {
    using enum ScenarioEvent::EventKind;
    switch (event.kind) {
      case kEdgeKill:
        return edge_.end(SIGKILL);
      case kEdgeStop:
        return edge_.end(SIGTERM);
      case kEdgeHandOver:
        return edge_.end(SIGHUP);
      case kEdgeStart:
        return start_edge();
      case kEdgePause:
        return edge_.signal(SIGSTOP);
      case kEdgeContinue:
        return edge_.signal(SIGCONT);
      case kBatteryPause:
        return signal(*programs_.battery, SIGSTOP);
      case kBatteryContinue:
        return signal(*programs_.battery, SIGCONT);
      case kMarketPause:
        return signal(*programs_.market, SIGSTOP);
      case kMarketContinue:
        return signal(*programs_.market, SIGCONT);
      case kMarketKill:
        signal(*programs_.market, SIGKILL);
        programs_.market->wait();
        return;
      case kMarketStart:
        return start_market();
      case kDiskFull:
        return disk_->fill();
      case kStateLost:
        return lose_state();
      case kHold:
        return edge_.say({"hold", std::to_string(event.power_w), "--for", seconds_text(event)});
      case kHoldRelease:
        return edge_.say({"hold", "--release"});
      case kLimit:
        return edge_.say({"limit", "--charge", limit_power_text(event.charge_w), "--discharge",
                          limit_power_text(event.discharge_w), "--for", seconds_text(event)});
      case kLimitClear:
        return edge_.say({"limit", "--clear"});
      case kLimitTorn:
        return write_file(edge_.config().site.limit_file.c_str(),
                          limit_line(event, edge_.now_utc_s()));
      case kClear:
        return edge_.say({"clear", "--yes"});
      case kClockStep:
      case kClockUnsynchronised:
      case kClockSynchronised:
        return;  // refused by the reader: wall time cannot step the clock
    }
  }

  /// Effect of a failed disk: files of the right size with invalid content.
  void lose_state() const {
    for (const char* const name : {"decisions.ring", "decisions.ring.old"}) {
      const std::string path = state_file(edge_.config(), name).c_str();
      std::error_code none;
      const auto size = std::filesystem::file_size(path, none);
      if (!none) write_file(path, std::string(size, '\xff'));
    }
  }

  static void signal(const ChildProcess& process, int number) { process.signal(number); }

  Evidence end() {
    real_run_ ? real_run_->give_back() : edge_.end(SIGTERM);
    Evidence evidence;
    evidence.edge_exit_code = edge_.exit_code();
    evidence.edge_last_line = edge_.last_line();
    evidence.is_alive_at_end = end_simulators();
    evidence.slack_s = slack_s(lateness_, scenario_.time_scale);
    evidence.log = edge_.records();
    if (real_run_) {
      real_run_->report_to(evidence);
    } else {
      evidence.orders = read_dispatch_events(folder_.file("orders.csv"));
      evidence.minutes = read_battery_record(folder_.file("battery.csv"));
    }
    return evidence;
  }

  /// True if they ran until now and ended normally.
  bool end_simulators() {
    const bool has_battery = real_run_ || SitePrograms::stop(*programs_.battery) == 0;
    const bool market_is_dead = programs_.market->pid() < 0;
    return (market_is_dead || SitePrograms::stop(*programs_.market) == 0) && has_battery;
  }

  const Scenario& scenario_;
  const MinuteSeries& prices_;
  const WorkFolder& folder_;
  Lateness lateness_;
  std::optional<SmallDisk> disk_;
  std::optional<PtyBridge> line_;
  SitePrograms programs_;
  EdgeProcess edge_;
  std::optional<RealDeviceRun> real_run_;
  std::string battery_link_;  ///< TOML for the link of a real one
};

}  // namespace

Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
                  const WorkFolder& folder) {
  return WallRun(scenario, prices, site, folder).run();
}

std::string why_not_wall(const Scenario& scenario) {
  return fills_a_disk(scenario) && geteuid() != 0 ? "needs root, to mount a small disk" : "";
}

}  // namespace bess
