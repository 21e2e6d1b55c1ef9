// bess-edge and bess-prices as processes of a run in wall time, started on one configuration, asked
// by their commands, read by their log; and a small file system that fills up.
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

// A small file system of its own for the edge's state, where this user may mount one.

class SmallDisk {
 public:
  explicit SmallDisk(std::string folder) : folder_(std::move(folder)) {
    constexpr int kBytes = 32 * 1'024 * 1'024;  // more than a log of 35 days
    mkdir(folder_.c_str(), 0755);
    if (mount("tmpfs", folder_.c_str(), "tmpfs", 0, fmt::format("size={}", kBytes).c_str()) != 0) {
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
