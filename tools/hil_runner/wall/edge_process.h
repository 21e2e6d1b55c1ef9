// Processes bess-edge and bess-prices of a run in wall time, with commands and log; and a small
// file system that can be filled.
#pragma once

#include <fmt/core.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/stat.h>

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "edge/app/settings/edge_config.h"
#include "edge/records/log/log_reader.h"
#include "shared/host/user_error.h"
#include "tools/hil_runner/base/work_folder.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/simulators/site/site_programs.h"

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
  void set_up(const Scenario& scenario, const std::string& settings) {
    config_ = load_edge_settings(scenario, folder_.file("edge.toml"), settings);
  }
  [[nodiscard]] const EdgeConfig& config() const { return config_; }
  [[nodiscard]] std::int64_t now_utc_s() const { return utc_seconds(config_.clock); }

  /// Starts the controller. `recording`: file of its bus traffic; empty: none.
  void start(const std::string& recording) {
    std::vector<std::string> words;
    if (!recording.empty()) words = {"--record", recording};
    if (prices_ == nullptr) {
      std::filesystem::path program(program_);
      std::string name = program.filename().string();
      name.replace(0, std::string_view("bess-edge").size(), "bess-prices");
      program.replace_filename(name);
      prices_ = start_logged({program.string(), "--config", folder_.file("edge.toml")},
                             folder_.file("prices.log"));
    }
    start_command(std::move(words));
  }
  /// Starts a longer command instead of the controller.
  void start_command(std::vector<std::string> words) {
    words.insert(words.begin(), program_);
    words.insert(words.end(), {"--config", folder_.file("edge.toml")});
    log_ = folder_.file(fmt::format("edge-{}.log", ++started_));
    process_ = start_logged(words, log_);
  }
  void signal(int number) const {
    if (process_ != nullptr) process_->signal(number);
  }
  /// Ends the process with this signal, if it runs.
  void end(int number) {
    if (process_ == nullptr) return;
    signal(SIGCONT);
    signal(number);
    exit_code_ = wait();
  }
  /// Waits for the end of a command; returns its exit code.
  int wait() {
    const int code = process_->wait();
    process_.reset();
    return code;
  }
  [[nodiscard]] bool runs() const { return process_ != nullptr && !process_->has_ended(); }
  [[nodiscard]] bool is_started() const { return process_ != nullptr; }

  /// Runs a command of bess-edge in parallel. Throws UserError if it fails.
  void say(std::vector<std::string> words) const {
    const std::string command = words.front();
    words.insert(words.begin(), program_);
    words.insert(words.end(), {"--config", folder_.file("edge.toml")});
    const std::string log = folder_.file("commands.log");
    const int code = start_logged(words, log)->wait();
    if (code != 0) fail("bess-edge {}: exit code {}: {}", command, code, last_line_of(log));
  }

  /// Exit code of the controller that ended last.
  [[nodiscard]] int exit_code() const { return exit_code_; }
  /// Of the newest log.
  [[nodiscard]] std::string last_line() const { return last_line_of(log_); }

  /// Records of its ring, as `bess-edge log` reads them, also while it is written.
  [[nodiscard]] std::vector<CycleRecord> records() const {
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
  [[nodiscard]] bool newest(CycleRecord& record) const {
    LogReader log;
    FileMessage error;
    return log.open(config_.log, error) && log.newest(record);
  }

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
