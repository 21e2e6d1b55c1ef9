// Scenario in scaled wall time: the real bess-edge with bess-sim battery and bess-sim market, over
// Modbus TCP or a pair of pseudo terminals, and over HTTP. Events kill, stop and continue
// processes. Alternatively the real bess-edge with a real battery.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "shared/host/minute_file.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "tools/hil_runner/base/stop_request.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/real/real_options.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/wall/edge_process.h"

namespace bess {

// Options of bess-sim for the battery, house, meter and market of a scenario.

/// `serial_device`: end of the line for the battery; empty: TCP. Writes a file for a house with
/// steps.
std::vector<std::string> battery_options(const Scenario& scenario, const std::string& serial_device,
                                         const WorkFolder& folder);

/// `prices`: minute file. Writes a file for day-ahead prices.
std::vector<std::string> market_options(const Scenario& scenario, const std::string& prices,
                                        const WorkFolder& folder);

// Worst wake-up latency of this machine during the life of this object.

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

// Real battery in a run: commissioned first, checked every second, and released at every end.

class RealDeviceRun {
 public:
  /// All must outlive this object.
  RealDeviceRun(const Scenario& scenario, const RealBattery& battery, const WorkFolder& folder,
                EdgeProcess& edge)
      : scenario_(scenario), battery_(battery), folder_(folder), edge_(edge) {}

  /// Commissioning by the edge: half a minute of a small order.
  void commission();
  /// Throws Interrupted on a stop request, UserError beyond the limits.
  void look();
  /// File for the bus traffic of the next edge.
  [[nodiscard]] std::string next_recording();
  [[nodiscard]] bool has_begun() const { return edge_.is_started() || !recordings_.empty(); }
  /// Stops the edge, which releases the battery; if not, releases it by a command and reports.
  void give_back();
  /// Adds orders from its bus traffic, and its measurements.
  void report_to(Evidence& evidence) const;

 private:
  void check_stop_request() const;
  void show(const CycleRecord& cycle) const;

  const Scenario& scenario_;
  const RealBattery& battery_;
  const WorkFolder& folder_;
  EdgeProcess& edge_;
  AbortKey key_;
  std::vector<std::string> recordings_;
  std::int64_t next_look_ns_ = 0;
};

/// Begin of the error message of a run on a late machine.
inline constexpr std::string_view kTooLate = "not judged: this machine was late";

/// Paths of the programs, and the real battery if any.
struct WallSite {
  std::string edge;
  std::string simulators;
  std::optional<RealBattery> battery{};  ///< empty: simulated
};

/// The run cannot be judged: the wake-up latency is too large for its time scale.
class HostTooSlow : public UserError {
 public:
  using UserError::UserError;
};

/// Throws HostTooSlow; UserError if a program fails or a real battery exceeds its limits;
/// Interrupted on a stop request. A real battery is released in all cases.
Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
                  const WorkFolder& folder);

/// Reason why this machine cannot run it; empty: it can.
std::string why_not_wall(const Scenario& scenario);

}  // namespace bess
