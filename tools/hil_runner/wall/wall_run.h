// A scenario in wall time, scaled: the real bess-edge between the real bess-sim battery and
// bess-sim market, over Modbus TCP or a pair of pseudo terminals, and over HTTP. Processes are
// killed, stopped and continued as the scenario says. Or the real bess-edge and a battery that is
// there already.
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

// What a scenario asks of battery, house, meter and market, in the words of bess-sim's command
// line.

/// `serial_device`: the battery's end of a line; empty: over TCP. Of a house with steps a file is
/// written.
std::vector<std::string> battery_options(const Scenario& scenario, const std::string& serial_device,
                                         const WorkFolder& folder);

/// On the minute file `prices`. Of day-ahead prices a file is written.
std::vector<std::string> market_options(const Scenario& scenario, const std::string& prices,
                                        const WorkFolder& folder);

// How late this machine wakes whoever sleeps, at worst, while this object lives.

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

// A real battery in a run: its sign is checked first, it is looked at every second, and however the
// run ends it is given back.

class RealVisit {
 public:
  /// All must outlive this object.
  RealVisit(const Scenario& scenario, const RealBattery& battery, const WorkFolder& folder,
            EdgeProcess& edge)
      : scenario_(scenario), battery_(battery), folder_(folder), edge_(edge) {}

  /// The edge's own check of the sign: half a minute of a small order.
  void commission();
  /// Throws Interrupted when somebody asked for the end, UserError beyond the limits.
  void look();
  /// Of its bus, of the edge that is started next.
  [[nodiscard]] std::string next_recording();
  [[nodiscard]] bool has_begun() const { return edge_.is_started() || !recordings_.empty(); }
  /// Stops the edge, which releases the battery; where it did not, says so and tries it once more.
  void give_back();
  /// What went over its bus, and what it measured.
  void tell(Evidence& evidence) const;

 private:
  void heed_stop() const;
  void show(const CycleRecord& cycle) const;

  const Scenario& scenario_;
  const RealBattery& battery_;
  const WorkFolder& folder_;
  EdgeProcess& edge_;
  AbortKey key_;
  std::vector<std::string> recordings_;
  std::int64_t next_look_ns_ = 0;
};

/// How the error of a run begins for which this machine was too late.
inline constexpr std::string_view kTooLate = "not judged: this machine was late";

/// What a run stands on: the programs that are started, and the battery if there is one already.
struct WallSite {
  std::string edge;
  std::string simulators;
  std::optional<RealBattery> battery{};  ///< nothing: a simulated one is started
};

/// What was run cannot be judged: the machine woke whoever slept too late for the scenario's pace.
class MachineTooLate : public UserError {
 public:
  using UserError::UserError;
};

/// Throws MachineTooLate; UserError when a program cannot be started or says why it does not run,
/// or a real battery's limits are broken; Interrupted when a stop was requested. A real battery is
/// released, however it ends.
Evidence run_wall(const Scenario& scenario, const MinuteSeries& prices, const WallSite& site,
                  const WorkFolder& folder);

/// What only another machine can do, in words; empty: it can run here.
std::string why_not_wall(const Scenario& scenario);

}  // namespace bess
