#include "workstation/cli/common_options.h"

#include <fmt/core.h>
#include <unistd.h>

#include <chrono>
#include <csignal>
#include <thread>

#include "shared/host/user_error.h"
#include "workstation/market/feed/elia_fetch.h"

namespace bess {
namespace {
constexpr int kThreadsMax = 256;
}

void CommonOptions::add_config(ProgramCommand& command) {
  command.option("--config", config_path, "TOML file; 'bess-train config' prints all keys");
}

void CommonOptions::add_seed_and_threads(ProgramCommand& command) {
  command.option("--seed", seed, "Seed of every random draw (default 1)").non_negative();
  command.option("--threads", threads, "Default: all cores").range(1, kThreadsMax);
}

void CommonOptions::add_market(ProgramCommand& command) {
  command.option("--delay", delay_min, "Observation delay in minutes, 0 to 5 (default 1)")
      .range(0, 5);
  command.option("--settlement", settlement, "minute (default) or step").one_of({"minute", "step"});
  command.option("--initial-soc", initial_soc_frac, "0..1, default 0.5");
}

RunConfig CommonOptions::resolve() const {
  RunConfig config = load_run_config(config_path);
  config.set_seed(seed.value_or(1));
  const int cores = static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
  config.set_threads(threads.value_or(cores));
  if (delay_min) config.market.observation_delay_min = *delay_min;
  if (settlement) config.market.settlement = parse_settlement(*settlement);
  if (initial_soc_frac) {
    const BatteryParameters& battery = config.battery;
    if (!(*initial_soc_frac >= battery.soc_min_frac && *initial_soc_frac <= battery.soc_max_frac)) {
      fail("--initial-soc {}: use {:g} to {:g}, the battery's SoC window", *initial_soc_frac,
           battery.soc_min_frac, battery.soc_max_frac);
    }
    config.initial_soc_frac = *initial_soc_frac;
  }
  return config;
}

std::atomic<bool>& interruption() {
  static std::atomic<bool> interrupted{false};
  static_assert(std::atomic<bool>::is_always_lock_free);
  return interrupted;
}

void end_when_interrupted() {
  const auto end = [](int) {
    constexpr std::string_view kMessage = "\nbess-train: interrupted\n";
    [[maybe_unused]] const auto written = write(STDERR_FILENO, kMessage.data(), kMessage.size());
    _exit(3);
  };
  std::signal(SIGINT, end);
  std::signal(SIGTERM, end);
}

void watch_interruption() {
  interruption();  // constructed before a signal can come
  const auto raise_flag = [](int) { interruption() = true; };
  std::signal(SIGINT, raise_flag);
  std::signal(SIGTERM, raise_flag);
}

void sleep_unless(double seconds, const std::atomic<bool>& interrupted) {
  using Clock = std::chrono::steady_clock;
  const auto end = Clock::now() + std::chrono::duration<double>(seconds);
  while (!interrupted && Clock::now() < end) {
    const std::chrono::duration<double> left = end - Clock::now();
    std::this_thread::sleep_for(std::min(left, std::chrono::duration<double>(0.1)));
  }
}

std::string checked_base_url(std::string url, const std::string& option) {
  while (url.ends_with('/')) url.pop_back();
  if (!url.starts_with("http://") && !url.starts_with("https://")) {
    fail("{} \"{}\" is not a web address; write it as {}", option, url, kEliaBaseUrl);
  }
  return url;
}

}  // namespace bess
