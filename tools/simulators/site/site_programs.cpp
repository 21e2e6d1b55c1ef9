#include "tools/simulators/site/site_programs.h"

#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <system_error>

#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

bool names(const std::vector<std::string>& options, const char* option) {
  return std::ranges::find(options, option) != options.end();
}

/// Port in "... listening on HOST:PORT, ..."; 1 for a serial line.
int port_in(const std::string& line) {
  const std::size_t colon = line.find(':', line.find("127.0.0.1"));
  return colon == std::string::npos ? 1 : std::atoi(line.c_str() + colon + 1);
}

}  // namespace

std::unique_ptr<ChildProcess> start_logged(std::vector<std::string> arguments,
                                           const std::string& log) {
  // Without setpriv (small systems) the child does not end with its parent.
  constexpr const char* kShell =
      "log=$0; command -v setpriv >/dev/null && set -- setpriv --pdeathsig TERM \"$@\"; "
      "exec \"$@\" >>\"$log\" 2>&1";
  arguments.insert(arguments.begin(), {"/bin/sh", "-c", kShell, log});
  return std::make_unique<ChildProcess>(arguments);
}

std::string last_line_of(const std::string& log) {
  std::ifstream file(log);
  std::string last;
  for (std::string line; std::getline(file, line);) {
    if (!line.empty()) last = line;
  }
  return last;
}

SitePrograms::SitePrograms(std::string simulators, std::string folder)
    : simulators_(std::move(simulators)), folder_(std::move(folder)) {}

SitePrograms::~SitePrograms() {
  std::error_code ignored;
  for (const auto& file : std::filesystem::directory_iterator("/run/lock", ignored)) {
    const std::string name = file.path().filename().string();
    for (const int port : battery_ports_) {
      const bool is_ours = name.starts_with("bess-127.0.0.1_" + std::to_string(port) + "_");
      if (is_ours) std::filesystem::remove(file.path(), ignored);
    }
  }
}

void SitePrograms::start_clock(double in_s) {
  clock.anchor_monotonic_ns = clock_ns(CLOCK_MONOTONIC) + static_cast<std::int64_t>(in_s * 1e9);
}

int SitePrograms::stop(ChildProcess& process) {
  process.signal(SIGCONT);
  process.signal(SIGTERM);
  return process.wait();
}

std::string SitePrograms::log_of(const std::string& name) const {
  const int number = name == "battery" ? batteries_ : markets_;
  return file(number > 1 ? name + "-" + std::to_string(number) + ".log" : name + ".log");
}

void SitePrograms::start_battery(const std::vector<std::string>& options) {
  std::vector<std::string> all = {"--record", file("battery.csv"), "--events", file("orders.csv")};
  if (!names(options, "--port") && !names(options, "--serial")) {
    all.insert(all.end(), {"--port", "0"});
  }
  all.insert(all.end(), options.begin(), options.end());
  ++batteries_;
  battery = start("battery", all);
  battery_port = port_in(listening("battery", "bess-sim battery:", *battery));
  battery_ports_.push_back(battery_port);
  if (!names(options, "--meter-map")) return;
  meter_port = port_in(listening("battery", "bess-sim battery: meter", *battery));
}

void SitePrograms::start_market(const std::vector<std::string>& options) {
  std::vector<std::string> all = options;
  if (!names(options, "--port")) all.insert(all.end(), {"--port", "0"});
  ++markets_;
  market = start("market", all);
  market_port = port_in(listening("market", "bess-sim market:", *market));
}

std::unique_ptr<ChildProcess> SitePrograms::start(const std::string& name,
                                                  const std::vector<std::string>& options) {
  std::vector<std::string> arguments = {simulators_, name};
  arguments.insert(arguments.end(),
                   {"--utc-start", utc_text(clock.anchor_utc_s).c_str(), "--time-scale",
                    std::to_string(clock.scale), "--anchor-monotonic-ns",
                    std::to_string(clock.anchor_monotonic_ns)});
  arguments.insert(arguments.end(), options.begin(), options.end());
  std::error_code ignored;
  std::filesystem::remove(log_of(name), ignored);  // of an earlier run in this folder
  return start_logged(arguments, log_of(name));
}

std::string SitePrograms::listening(const std::string& name, const std::string& who,
                                    const ChildProcess& process) const {
  constexpr std::int64_t kWaitNs = 20 * kNanosecondsPerSecond;
  constexpr useconds_t kLookUs = 2'000;
  const std::int64_t until_ns = clock_ns(CLOCK_MONOTONIC) + kWaitNs;
  while (clock_ns(CLOCK_MONOTONIC) < until_ns) {
    const bool has_ended = process.has_ended();  // read first, so that its last lines count
    std::ifstream log(log_of(name));
    for (std::string line; std::getline(log, line);) {
      const bool is_whole = !log.eof();
      if (is_whole && line.find(who + " listening on ") != std::string::npos) return line;
    }
    if (has_ended) break;
    usleep(kLookUs);
  }
  fail("a simulator did not start: {}", last_line_of(log_of(name)));
}

}  // namespace bess
