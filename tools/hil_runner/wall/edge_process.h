// Processes bess-edge and bess-prices of a run in wall time, with commands and log; and a small
// file system that can be filled.
#pragma once

#include <fmt/core.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <cstdint>
#include <fstream>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "shared/host/child_process.h"
#include "shared/host/user_error.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/scenario/scenario.h"

namespace bess {

// Small file system for the edge's state; needs the right to mount.

class SmallDisk {
 public:
  explicit SmallDisk(std::string folder) : folder_(std::move(folder)) {
    constexpr int kBytes = 32 * 1'024 * 1'024;  // larger than a log of 35 days
    mkdir(folder_.c_str(), 0755);
    if (mount("tmpfs", folder_.c_str(), "tmpfs", 0, fmt::format("size={}", kBytes).c_str()) != 0) {
      fail("{}: cannot mount a small disk: needs root", folder_);
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

class EdgeProcess {
 public:
  /// Configuration: edge.toml in the folder. Both must outlive this object.
  EdgeProcess(const std::string& program, const WorkFolder& folder)
      : program_(program), folder_(folder) {}

  /// Writes the configuration, and reads it as bess-edge does.
  void set_up(const Scenario& scenario, const std::string& settings);
  [[nodiscard]] const EdgeConfig& config() const { return config_; }
  [[nodiscard]] std::int64_t now_utc_s() const;

  /// Starts the controller. `recording`: file of its bus traffic; empty: none.
  void start(const std::string& recording);
  /// Starts a longer command instead of the controller.
  void start_command(std::vector<std::string> words);
  void signal(int number) const;
  /// Ends the process with this signal, if it runs.
  void end(int number);
  /// Waits for the end of a command; returns its exit code.
  int wait();
  [[nodiscard]] bool runs() const { return process_ != nullptr && !process_->has_ended(); }
  [[nodiscard]] bool is_started() const { return process_ != nullptr; }

  /// Runs a command of bess-edge in parallel. Throws UserError if it fails.
  void say(std::vector<std::string> words) const;

  /// Exit code of the controller that ended last.
  [[nodiscard]] int exit_code() const { return exit_code_; }
  [[nodiscard]] std::string last_line() const;  ///< of the newest log

  /// Records of its ring, as `bess-edge log` reads them, also while it is written.
  [[nodiscard]] std::vector<CycleRecord> records() const;
  [[nodiscard]] bool newest(CycleRecord& record) const;

 private:
  const std::string& program_;
  const WorkFolder& folder_;
  EdgeConfig config_;
  std::unique_ptr<ChildProcess> prices_;  ///< bess-prices; continues without the edge
  std::unique_ptr<ChildProcess> process_;
  std::string log_;
  int started_ = 0;
  int exit_code_ = 0;
};

}  // namespace bess
