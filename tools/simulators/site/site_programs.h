// Programs of a testbed: bess-sim battery with house and meter, and bess-sim market, on free ports
// and one clock. They end when the parent process ends.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "shared/host/child_process.h"
#include "tools/simulators/site/controller_settings.h"

namespace bess {

/// Starts a program with its output in a file: an unread pipe would block it. It ends with this
/// process.
std::unique_ptr<ChildProcess> start_logged(std::vector<std::string> arguments,
                                           const std::string& log);
/// Last line that is not empty; empty: none.
std::string last_line_of(const std::string& log);

class SitePrograms {
 public:
  /// `simulators`: path of bess-sim. Output files and logs go to `folder`.
  SitePrograms(std::string simulators, std::string folder);
  SitePrograms(const SitePrograms&) = delete;
  SitePrograms& operator=(const SitePrograms&) = delete;
  /// Also removes the battery locks that a killed controller leaves.
  ~SitePrograms();

  /// Simulated time begins `in_s` from now, for simulators started after this call.
  void start_clock(double in_s);

  /// On any free port unless the options name a port or a serial line. Writes battery.csv and
  /// orders.csv. Throws UserError with its last line when it does not listen.
  void start_battery(const std::vector<std::string>& options);
  /// The options must contain --prices.
  void start_market(const std::vector<std::string>& options);

  /// Sends SIGTERM, also to a paused process; returns its exit code.
  static int stop(ChildProcess& process);

  /// Path of a file in the folder.
  [[nodiscard]] std::string file(const std::string& name) const {
    return (folder_ / name).string();
  }
  /// Log of the newest "battery" or "market".
  [[nodiscard]] std::string log_of(const std::string& name) const;

  ScaledClock clock;
  // No process listens on port 1.
  int battery_port = 1;
  int meter_port = 1;
  int market_port = 1;
  std::unique_ptr<ChildProcess> battery, market;

 private:
  std::unique_ptr<ChildProcess> start(const std::string& name,
                                      const std::vector<std::string>& options);
  [[nodiscard]] std::string listening(const std::string& name, const std::string& who,
                                      const ChildProcess& process) const;

  std::string simulators_;
  std::filesystem::path folder_;
  int batteries_ = 0;
  int markets_ = 0;
  std::vector<int> battery_ports_;
};

}  // namespace bess
