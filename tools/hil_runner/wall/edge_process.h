// bess-edge and bess-prices as processes of a run in wall time: started again and again on one
// configuration,
// spoken to by its own commands, read by its own log.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "edge/settings/edge_config.h"
#include "shared/host/child_process.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

class EdgeProcess {
 public:
  /// Its configuration is edge.toml of the folder. Both must outlive this object.
  EdgeProcess(const std::string& program, const WorkFolder& folder)
      : program_(program), folder_(folder) {}

  /// Writes and reads the configuration, as bess-edge will.
  void set_up(const Scenario& scenario, const std::string& settings);
  [[nodiscard]] const EdgeConfig& config() const { return config_; }
  [[nodiscard]] std::int64_t now_utc_s() const;

  /// The controller. `recording`: of its bus; empty: none.
  void start(const std::string& recording);
  /// A command that may last, in its place.
  void start_command(std::vector<std::string> words);
  void signal(int number) const;
  /// By this signal; nothing where it has ended, or was never started.
  void end(int number);
  /// Waits for a command's end; its exit code.
  int wait();
  [[nodiscard]] bool runs() const { return process_ != nullptr && !process_->has_ended(); }
  [[nodiscard]] bool is_started() const { return process_ != nullptr; }

  /// What a person says to it, by a command of bess-edge beside it. Throws UserError when it is
  /// refused.
  void say(std::vector<std::string> words) const;

  /// Of the controller that was ended last.
  [[nodiscard]] int exit_code() const { return exit_code_; }
  [[nodiscard]] std::string last_line() const;  ///< by the newest

  /// The records of its ring, as `bess-edge log` reads them, while it is written or afterwards.
  [[nodiscard]] std::vector<CycleRecord> records() const;
  [[nodiscard]] bool newest(CycleRecord& record) const;

 private:
  const std::string& program_;
  const WorkFolder& folder_;
  EdgeConfig config_;
  std::unique_ptr<ChildProcess> prices_;  ///< bess-prices; goes on while the edge is down
  std::unique_ptr<ChildProcess> process_;
  std::string log_;
  int started_ = 0;
  int exit_code_ = 0;
};

}  // namespace bess
