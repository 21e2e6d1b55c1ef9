// The programs of a simulated site: bess-sim battery, with its house and its meter, and bess-sim
// market, on free ports and one clock. They end with whoever started them, however that ends.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "shared/host/child_process.h"
#include "tools/simulators/site/controller_settings.h"

namespace bess {

/// A program whose output goes to a file: a pipe that nobody reads would stop it. It ends with this
/// one.
std::unique_ptr<ChildProcess> start_logged(std::vector<std::string> arguments,
                                           const std::string& log);
/// That is not empty; empty: there is none.
std::string last_line_of(const std::string& log);

class SitePrograms {
 public:
  /// `simulators`: the program bess-sim. What they write and say goes to files of `folder`.
  SitePrograms(std::string simulators, std::string folder);
  SitePrograms(const SitePrograms&) = delete;
  SitePrograms& operator=(const SitePrograms&) = delete;
  /// What a killed controller leaves where all controllers of a machine lock their batteries goes
  /// too.
  ~SitePrograms();

  /// Simulated time begins so long from now, for simulators that are started after this.
  void start_clock(double in_s);

  /// On any free port unless the options name one, or a serial line; recorded in battery.csv and
  /// orders.csv. Throws UserError with its last line when it does not listen.
  void start_battery(const std::vector<std::string>& options);
  /// Options say at least --prices.
  void start_market(const std::vector<std::string>& options);

  /// As a person would: SIGTERM, also to one that stands still. Its exit code.
  static int stop(ChildProcess& process);

  /// File of the folder.
  [[nodiscard]] std::string file(const std::string& name) const {
    return (folder_ / name).string();
  }
  /// Of the newest one, "battery" or "market".
  [[nodiscard]] std::string log_of(const std::string& name) const;

  SiteClock clock;
  // Nobody listens at port 1 before a simulator does.
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
