#include "tools/hil_runner/wall/wall_run.h"

#include <fmt/core.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <thread>

#include "edge/battery/commission.h"
#include "edge/log/log_reader.h"
#include "edge/storage/commission_file.h"
#include "shared/host/child_process.h"
#include "shared/host/file.h"
#include "shared/host/pty_bridge.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"
#include "tools/battery_sim/battery_record.h"
#include "tools/hil_runner/base/stop_request.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/hil_runner/scenario/limit_line.h"
#include "tools/hil_runner/scenario/scenario_house.h"

namespace bess {
namespace {

constexpr std::int64_t kStartUpNs = 1'200'000'000;  ///< wall, for all processes to be up
// Wall seconds that an order may need, and how much later it may be for what this machine oversleeps.
constexpr double kLateS = 0.15;
constexpr double kLateFactor = 2;
constexpr double kSlackMaxS =
    60;  ///< simulated: later, an order would be judged by the next cycle's price
constexpr int kSmallDiskBytes = 32 * 1'024 * 1'024;  // more than a log of 35 days

/// A program whose output goes to a file: a pipe that nobody reads would stop it. It ends with this one, however
/// that ends.
std::unique_ptr<ChildProcess> start_logged(std::vector<std::string> arguments,
                                           const std::string& log) {
  arguments.insert(
      arguments.begin(),
      {"/bin/sh", "-c", "log=$0; exec setpriv --pdeathsig TERM \"$@\" >>\"$log\" 2>&1", log});
  return std::make_unique<ChildProcess>(arguments);
}

std::string last_line(const std::string& path) {
  std::ifstream file(path);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

/// The first that has this text in it; empty: none.
std::string line_with(const std::string& text, const std::string& path) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);) {
    if (line.find(text) != std::string::npos) return line;
  }
  return "";
}

/// A small file system of its own for the edge's state, where this user may mount one.
class SmallDisk {
 public:
  explicit SmallDisk(std::string folder) : folder_(std::move(folder)) {
    mkdir(folder_.c_str(), 0755);
    if (mount("tmpfs", folder_.c_str(), "tmpfs", 0,
              fmt::format("size={}", kSmallDiskBytes).c_str()) != 0) {
      fail("{}: no small disk can be mounted here: that needs root", folder_);
    }
  }
  SmallDisk(const SmallDisk&) = delete;
  SmallDisk& operator=(const SmallDisk&) = delete;
  ~SmallDisk() { umount2(folder_.c_str(), MNT_DETACH); }
  void fill() const {
    std::ofstream file(folder_ + "/filler", std::ios::binary);
    const std::string block(4'096, 'x');
    while (file.write(block.data(), static_cast<std::streamsize>(block.size())).flush()) continue;
  }

 private:
  std::string folder_;
};

/// How late this machine wakes whoever sleeps, at worst.
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

class WallRun {
 public:
  WallRun(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
          const WorkFolder& folder)
      : scenario_(scenario), prices_(prices), site_(site), folder_(folder) {
    using enum ScenarioEvent::Does;
    if (std::ranges::any_of(scenario.events, [](const auto& e) { return e.does == kDiskFull; })) {
      disk_.emplace(folder.file("state"));
    }
  }

  WallRun(const WallRun&) = delete;
  WallRun& operator=(const WallRun&) = delete;
  /// What a killed edge leaves where all of a machine lock their batteries.
  ~WallRun() {
    std::error_code ignored;
    const std::string prefix = fmt::format("bess-127.0.0.1_{}_", battery_port_);
    for (const auto& file : std::filesystem::directory_iterator("/run/lock", ignored)) {
      const bool is_ours = file.path().filename().string().starts_with(prefix);
      if (is_ours) std::filesystem::remove(file.path(), ignored);
    }
  }

  Evidence run() {
    write_minute_file(folder_.file("minutes.csv"), prices_, "");
    anchor_ns_ = clock_ns(CLOCK_MONOTONIC) + kStartUpNs;
    if (!site_.battery) {
      if (scenario_.battery.rtu) line_.emplace();
      start_battery();
      return run_edge();
    }
    key_.emplace();
    try {
      commission();
      anchor_ns_ = clock_ns(CLOCK_MONOTONIC) + kStartUpNs;
      return run_edge();
    } catch (...) {
      if (edge_ != nullptr || !recordings_.empty()) give_back();
      throw;
    }
  }

 private:
  [[nodiscard]] std::string settings() const {
    return edge_settings(scenario_, prices_,
                         {.battery_port = battery_port_,
                          .serial_device = line_ ? line_->device(1) : "",
                          .battery_link = site_.battery ? link_keys(*site_.battery) : "",
                          .market_port = market_port_,
                          .meter_port = meter_port_,
                          .anchor_monotonic_ns = anchor_ns_});
  }

  Evidence run_edge() {
    start_market();
    config_ = load_edge_settings(scenario_, folder_.file("edge.toml"), settings());
    if (!site_.battery) pretend_commissioned();
    start_edge();
    for (const ScenarioEvent& event : scenario_.events) {
      sleep_until_minute(event.at_min);
      apply(event);
    }
    sleep_until_minute(scenario_.minutes);
    return end();
  }

  /// The sign of a simulated battery is known.
  void pretend_commissioned() const {
    std::string error;
    const CommissionResult passed{.verdict = CommissionVerdict::kPassed};
    if (!write_commission_file(config_, passed, scenario_.start_utc_s, error))
      throw UserError(error);
  }

  void sleep_until_minute(double minute) {
    constexpr std::int64_t kLookNs = 50'000'000;
    const auto wall_ns = static_cast<std::int64_t>(minute * 60e9 / scenario_.time_scale);
    const std::int64_t until_ns = anchor_ns_ + wall_ns;
    for (std::int64_t now_ns = 0; (now_ns = clock_ns(CLOCK_MONOTONIC)) < until_ns;) {
      look();
      sleep_until_monotonic(std::min(until_ns, now_ns + kLookNs));
    }
  }

  // --- a real battery -----------------------------------------------------------------------------
  /// Throws when somebody asked for the end.
  void heed_stop() const {
    if (key_ && key_->is_pressed()) request_stop();
    throw_if_stopped();
  }

  /// Throws when it is to end.
  void look() {
    heed_stop();
    if (!site_.battery || clock_ns(CLOCK_MONOTONIC) < next_look_ns_) return;
    next_look_ns_ = clock_ns(CLOCK_MONOTONIC) + kNanosecondsPerSecond;
    LogReader log;
    FileMessage error;
    CycleRecord cycle;
    if (!log.open(config_.log, error) || !log.newest(cycle)) return;
    tell(cycle);
    const std::string broken = beyond_limits(cycle, *site_.battery);
    if (!broken.empty()) fail("stopped: {}, beyond the limits of --real", broken);
  }

  void tell(const CycleRecord& cycle) const {
    if (isatty(STDERR_FILENO) == 0) return;
    fmt::print(stderr,
               "\r{}: minute {} of {:.0f}, {} W ordered, {} W measured, SoC {:.1f} %; Q ends it  ",
               scenario_.name, (cycle.utc_s - scenario_.start_utc_s) / 60, scenario_.minutes,
               cycle.ordered_power_w, cycle.measurement.power_w, cycle.measurement.soc_e4 / 100.0);
  }

  /// The edge's own check of the sign: half a minute of a small order.
  void commission() {
    config_ = load_edge_settings(scenario_, folder_.file("edge.toml"), settings());
    start_edge_with({"commission", "--config", folder_.file("edge.toml"), "--yes"});
    while (!edge_->has_ended()) {
      heed_stop();
      usleep(50'000);
    }
    const int code = edge_->wait();
    edge_.reset();
    if (code != 0) fail("{}", last_line(edge_log_));
  }

  /// Stops the edge, which releases the battery; where it did not, says so and tries it once more.
  void give_back() {
    end_edge(SIGTERM);
    const std::string said = std::filesystem::exists(edge_log_) ? read_file(edge_log_) : "";
    for (const char* const done : {"stopped: battery released", "stopped: no order was in force"}) {
      if (said.find(done) == std::string::npos) continue;
      return fmt::print(stderr, "{}: {}\n", scenario_.name, done);
    }
    start_edge_with({"release", "--config", folder_.file("edge.toml"), "--yes"});
    const int code = edge_->wait();
    edge_.reset();
    fmt::print(stderr, "{}: {}\n", scenario_.name, last_line(edge_log_));
    if (code != 0) fmt::print(stderr, "{}: NOT RELEASED, look after the battery\n", scenario_.name);
  }

  [[nodiscard]] std::vector<std::string> simulator(const std::string& name) const {
    return {site_.simulators,        name,
            "--utc-start",           std::string(utc_text(scenario_.start_utc_s).view()),
            "--time-scale",          std::to_string(scenario_.time_scale),
            "--anchor-monotonic-ns", std::to_string(anchor_ns_)};
  }

  /// Port of the line "... WHO listening on HOST:PORT, ...", when it has come.
  [[nodiscard]] static int port_of(const std::string& who, const std::string& log,
                                   const ChildProcess& process) {
    constexpr std::int64_t kWaitNs = 20 * kNanosecondsPerSecond;
    const std::int64_t until_ns = clock_ns(CLOCK_MONOTONIC) + kWaitNs;
    while (clock_ns(CLOCK_MONOTONIC) < until_ns) {
      const std::string line = line_with(who + " listening on ", log);
      if (!line.empty()) return port_in(line);
      if (kill(process.pid(), 0) != 0) break;
      usleep(2'000);
    }
    fail("a simulator did not start: {}", last_line(log));
  }
  static int port_in(const std::string& line) {
    const std::size_t colon = line.find(':', line.find("127.0.0.1"));
    if (colon == std::string::npos) return 0;
    return static_cast<int>(std::strtol(line.c_str() + colon + 1, nullptr, 10));
  }

  void start_battery() {
    const ScenarioBattery& b = scenario_.battery;
    const BatteryFaultWindow& fault = scenario_.battery_fault;
    std::vector<std::string> arguments = simulator("battery");
    const auto add = [&](const char* name, const std::string& value) {
      arguments.insert(arguments.end(), {name, value});
    };
    add("--map", b.map);
    if (!b.variant.empty()) add("--variant", b.variant);
    add("--soc", fmt::format("{}", b.soc_frac));
    add("--power-w", fmt::format("{}", b.physics.power_w_max));
    add("--capacity-wh", fmt::format("{}", b.physics.capacity_wh));
    add("--soc-min", fmt::format("{}", b.physics.soc_min_frac));
    add("--soc-max", fmt::format("{}", b.physics.soc_max_frac));
    add("--record", folder_.file("battery.csv"));
    add("--events", folder_.file("orders.csv"));
    if (line_) {
      add("--serial", line_->device(0));
      add("--baud", "115200");
    } else {
      add("--port", "0");
    }
    for (const BatteryFault kind : fault.schedule.faults) {
      add("--fault", battery_faults()[static_cast<std::size_t>(kind) - 1].name);
    }
    if (!fault.schedule.faults.empty()) add_faults(fault, add);
    add_house(add);
    const bool has_meter = scenario_.meter.source == ScenarioMeter::Source::kMap;
    if (has_meter) add_meter(add);
    const std::string log = folder_.file("battery.log");
    battery_ = start_logged(arguments, log);
    battery_port_ = std::max(1, port_of("bess-sim battery:", log, *battery_));
    if (has_meter) meter_port_ = port_of("bess-sim battery: meter", log, *battery_);
  }

  template <typename Add>
  void add_house(const Add& add) const {
    if (!scenario_.house.exists()) return;
    if (scenario_.house.seed) {
      add("--house", "daily");
      return add("--house-seed", std::to_string(*scenario_.house.seed));
    }
    write_file(folder_.file("house.csv"), house_csv(scenario_));
    add("--house", folder_.file("house.csv"));
  }

  template <typename Add>
  void add_meter(const Add& add) const {
    const FaultSchedule& faults = scenario_.meter.fault.schedule;
    add("--meter-map", scenario_.meter.map);
    if (!scenario_.meter.variant.empty()) add("--meter-variant", scenario_.meter.variant);
    add("--meter-port", "0");
    if (faults.faults.empty()) return;
    for (const BatteryFault kind : faults.faults) {
      add("--meter-fault", battery_faults()[static_cast<std::size_t>(kind) - 1].name);
    }
    add("--meter-fault-from-s", fmt::format("{}", faults.from_s));
    if (faults.to_s != kNeverMin) add("--meter-fault-to-s", fmt::format("{}", faults.to_s));
    if (faults.off_s == 0) return;
    add("--meter-fault-on-s", fmt::format("{}", faults.on_s));
    add("--meter-fault-off-s", fmt::format("{}", faults.off_s));
  }

  template <typename Add>
  static void add_faults(const BatteryFaultWindow& fault, const Add& add) {
    const FaultSchedule& schedule = fault.schedule;
    if (schedule.probability > 0) {
      add("--fault-probability", fmt::format("{}", schedule.probability));
    } else {
      add("--fault-every", std::to_string(schedule.every));
    }
    add("--late-ms", std::to_string(fault.late_ms));
    add("--drip-ms", std::to_string(fault.drip_ms));
    add("--exception-code", std::to_string(fault.exception_code));
    add("--fault-seed", std::to_string(schedule.seed));
    add("--fault-period-s", std::to_string(schedule.period_s));
    add("--fault-from-s", fmt::format("{}", schedule.from_s));
    if (schedule.to_s != kNeverMin) add("--fault-to-s", fmt::format("{}", schedule.to_s));
    if (schedule.off_s == 0) return;
    add("--fault-on-s", fmt::format("{}", schedule.on_s));
    add("--fault-off-s", fmt::format("{}", schedule.off_s));
  }

  void start_market() {
    const PriceFaultWindow& fault = scenario_.price_fault;
    std::vector<std::string> arguments = simulator("market");
    const auto add = [&](const char* name, const std::string& value) {
      arguments.insert(arguments.end(), {name, value});
    };
    add("--prices", folder_.file("minutes.csv"));
    add("--port", std::to_string(market_port_));
    add("--latency-s", fmt::format("{}", scenario_.prices.latency_s));
    if (fault.fault != MarketFault::kNone) {
      add("--fault", kMarketFaultNames[static_cast<int>(fault.fault)]);
      add("--fault-every", std::to_string(fault.every));
      add("--fault-from-s", fmt::format("{}", 60 * fault.span.from_min));
      if (fault.span.to_min != kNeverMin)
        add("--fault-to-s", fmt::format("{}", 60 * fault.span.to_min));
    }
    const std::string log = folder_.file(fmt::format("market-{}.log", ++markets_));
    market_ = start_logged(arguments, log);
    market_port_ = port_of("bess-sim market:", log, *market_);
  }

  void start_edge() {
    std::vector<std::string> arguments = {"--config", folder_.file("edge.toml")};
    if (site_.battery) {
      recordings_.push_back(folder_.file(fmt::format("bus-{}.jsonl", recordings_.size() + 1)));
      arguments.insert(arguments.end(), {"--record", recordings_.back()});
    }
    start_edge_with(arguments);
  }
  void start_edge_with(std::vector<std::string> arguments) {
    arguments.insert(arguments.begin(), site_.edge);
    edge_log_ = folder_.file(fmt::format("edge-{}.log", ++edges_));
    edge_ = start_logged(arguments, edge_log_);
  }

  void apply(const ScenarioEvent& event) {
    using enum ScenarioEvent::Does;
    switch (event.does) {
      case kEdgeKill:
        return end_edge(SIGKILL);
      case kEdgeStop:
        return end_edge(SIGTERM);
      case kEdgeHandOver:
        return end_edge(SIGHUP);
      case kEdgeStart:
        return start_edge();
      case kEdgePause:
        return signal(edge_, SIGSTOP);
      case kEdgeContinue:
        return signal(edge_, SIGCONT);
      case kBatteryPause:
        return signal(battery_, SIGSTOP);
      case kBatteryContinue:
        return signal(battery_, SIGCONT);
      case kMarketPause:
        return signal(market_, SIGSTOP);
      case kMarketContinue:
        return signal(market_, SIGCONT);
      case kMarketKill:
        signal(market_, SIGKILL);
        market_.reset();
        return;
      case kMarketStart:
        return start_market();
      case kHold:
        return say({"hold", std::to_string(event.power_w), "--for", seconds_text(event)});
      case kHoldRelease:
        return say({"hold", "--release"});
      case kLimit:
        return say({"limit", "--charge", limit_power_text(event.charge_w), "--discharge",
                    limit_power_text(event.discharge_w), "--for", seconds_text(event)});
      case kLimitClear:
        return say({"limit", "--clear"});
      case kLimitTorn:
        return write_file(config_.site.limit_file.c_str(), limit_line(event, now_utc_s()));
      case kClear:
        return say({"clear", "--yes"});
      case kDiskFull:
        return disk_->fill();
      case kClockStep:
      case kClockUnsynchronised:
      case kClockSynchronised:
        return;  // refused by the reader: the clock of this machine is not touched
    }
  }

  /// By the command with which a person says it.
  void say(std::vector<std::string> command) {
    command.insert(command.begin(), site_.edge);
    command.insert(command.end(), {"--config", folder_.file("edge.toml")});
    const std::string log = folder_.file("commands.log");
    const int code = start_logged(command, log)->wait();
    if (code != 0) fail("bess-edge {}: exit code {}: {}", command[1], code, last_line(log));
  }
  static std::string seconds_text(const ScenarioEvent& event) {
    return std::to_string(event.for_s) + "s";
  }
  [[nodiscard]] std::int64_t now_utc_s() const {
    return config_.clock.now_utc_ns() / kNanosecondsPerSecond;
  }

  static void signal(const std::unique_ptr<ChildProcess>& process, int number) {
    if (process != nullptr) process->signal(number);
  }
  void end_edge(int number) {
    if (edge_ == nullptr) return;
    signal(edge_, SIGCONT);
    signal(edge_, number);
    exit_code_ = edge_->wait();
    edge_.reset();
  }
  /// True when it was there until now, and ended as it should.
  static bool end_simulator(std::unique_ptr<ChildProcess>& process) {
    if (process == nullptr) return true;
    signal(process, SIGCONT);
    signal(process, SIGTERM);
    return process->wait() == 0;
  }

  Evidence end() {
    if (site_.battery) {
      give_back();
    } else {
      end_edge(SIGTERM);
    }
    Evidence evidence;
    evidence.edge_exit_code = exit_code_;
    evidence.edge_last_line = last_line(edge_log_);
    const bool has_battery = end_simulator(battery_);
    evidence.is_alive_at_end = end_simulator(market_) && has_battery;
    const double late_s = kLateS + kLateFactor * lateness_.worst_s();
    evidence.slack_s = 2 + late_s * scenario_.time_scale;
    if (evidence.slack_s > kSlackMaxS) {
      fail(
          "not judged: this machine was late by {:.2f} s, at time scale {} too late for a cycle of "
          "120 s; "
          "fewer --jobs, or a smaller time_scale",
          lateness_.worst_s(), scenario_.time_scale);
    }
    evidence.log = read_log();
    if (site_.battery) {
      evidence.orders = orders_on_the_bus(recordings_, config_.map, scenario_.end_utc_ns());
      evidence.minutes = measured_minutes(evidence.log);
    } else {
      evidence.orders = read_dispatch_events(folder_.file("orders.csv"));
      evidence.minutes = read_battery_record(folder_.file("battery.csv"));
    }
    return evidence;
  }

  /// As `bess-edge log` reads it, while it is written or afterwards.
  [[nodiscard]] std::vector<CycleRecord> read_log() const {
    std::vector<CycleRecord> records;
    LogReader log;
    FileMessage error;
    if (!log.open(config_.log, error)) return records;
    CycleRecord record;
    for (std::uint64_t n = log.oldest_number(); n <= log.newest_number(); ++n) {
      if (log.read(n, record)) records.push_back(record);
    }
    return records;
  }

  const Scenario& scenario_;
  const MinuteSeries& prices_;
  const WallSite& site_;
  const WorkFolder& folder_;
  Lateness lateness_;
  std::optional<SmallDisk> disk_;
  std::optional<PtyBridge> line_;
  std::optional<AbortKey> key_;
  std::vector<std::string> recordings_;  ///< of a real battery's bus, one of each edge that ran
  std::int64_t next_look_ns_ = 0;
  EdgeConfig config_;
  std::int64_t anchor_ns_ = 0;
  int battery_port_ = 1;
  int market_port_ = 0;
  int meter_port_ = 0;
  int markets_ = 0;
  int edges_ = 0;
  std::string edge_log_;  ///< of the one that was started last
  int exit_code_ = 0;
  std::unique_ptr<ChildProcess> battery_, market_, edge_;
};

}  // namespace

Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
                  const WorkFolder& folder) {
  return WallRun(scenario, prices, site, folder).run();
}

std::string why_not_wall(const Scenario& scenario) {
  const bool needs_root = std::ranges::any_of(scenario.events, [](const ScenarioEvent& event) {
    return event.does == ScenarioEvent::Does::kDiskFull;
  });
  return needs_root && geteuid() != 0 ? "needs root, to mount a small disk" : "";
}

}  // namespace bess
