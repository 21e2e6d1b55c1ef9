#include "tools/hil_runner/wall/edge_process.h"

#include <signal.h>

#include <filesystem>
#include <string_view>

#include "edge/records/log/log_reader.h"
#include "tools/hil_runner/scenario/edge_settings.h"
#include "tools/simulators/site/site_programs.h"

namespace bess {

void EdgeProcess::set_up(const Scenario& scenario, const std::string& settings) {
  config_ = load_edge_settings(scenario, folder_.file("edge.toml"), settings);
}

std::int64_t EdgeProcess::now_utc_s() const {
  return config_.clock.now_utc_ns() / kNanosecondsPerSecond;
}

void EdgeProcess::start(const std::string& recording) {
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

void EdgeProcess::start_command(std::vector<std::string> words) {
  words.insert(words.begin(), program_);
  words.insert(words.end(), {"--config", folder_.file("edge.toml")});
  log_ = folder_.file(fmt::format("edge-{}.log", ++started_));
  process_ = start_logged(words, log_);
}

void EdgeProcess::signal(int number) const {
  if (process_ != nullptr) process_->signal(number);
}

void EdgeProcess::end(int number) {
  if (process_ == nullptr) return;
  signal(SIGCONT);
  signal(number);
  exit_code_ = wait();
}

int EdgeProcess::wait() {
  const int code = process_->wait();
  process_.reset();
  return code;
}

void EdgeProcess::say(std::vector<std::string> words) const {
  const std::string command = words.front();
  words.insert(words.begin(), program_);
  words.insert(words.end(), {"--config", folder_.file("edge.toml")});
  const std::string log = folder_.file("commands.log");
  const int code = start_logged(words, log)->wait();
  if (code != 0) fail("bess-edge {}: exit code {}: {}", command, code, last_line_of(log));
}

std::string EdgeProcess::last_line() const { return last_line_of(log_); }

std::vector<CycleRecord> EdgeProcess::records() const {
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

bool EdgeProcess::newest(CycleRecord& record) const {
  LogReader log;
  FileMessage error;
  return log.open(config_.log, error) && log.newest(record);
}

}  // namespace bess
