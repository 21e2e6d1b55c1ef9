#include "workstation/runs/chain/common_options.h"

#include <cstdlib>
#include <thread>

#include "shared/host/text.h"
#include "shared/host/user_error.h"
#include "workstation/data/market/feed/elia_fetch.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

constexpr int kThreadsMax = 256;

/// Relative to the current folder if inside it.
fs::path shortened(const fs::path& path) {
  std::error_code error;
  const fs::path relative = fs::relative(path, error);
  return error || relative.empty() || *relative.begin() == ".." ? path : relative;
}

}  // namespace

void CommonOptions::add_config(ProgramCommand& command) {
  command.option("--config", config_path,
                 "configuration file (TOML); 'bess-train config' prints all keys");
}

void CommonOptions::add_threads(ProgramCommand& command) {
  command.option("--threads", threads, "threads (default: all cores)").range(1, kThreadsMax);
}

void CommonOptions::add_market(ProgramCommand& command) {
  command.option("--delay", delay_min, "observation delay, minutes (default 1)").range(0, 5);
  command.option("--settlement", settlement, "settlement per minute or per step (default minute)")
      .one_of({"minute", "step"});
  command.option("--initial-soc", initial_soc_frac, "initial SoC, 0 to 1 (default 0.5)");
}

RunConfig CommonOptions::resolve(ContextKind unless_said) const {
  return resolve(load_run_config(config_path, unless_said));
}

RunConfig CommonOptions::resolve(RunConfig config) const {
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

std::vector<double> numbers_in(const std::vector<std::string>& texts, double low, double high,
                               const std::string& option, const std::string& usage) {
  std::vector<double> numbers;
  for (const std::string& text : texts) {
    double number = 0;
    if (!read_number(text, number) || !(number >= low && number <= high)) {
      fail("{} {}: use {}", option, text, usage);
    }
    numbers.push_back(number);
  }
  return numbers;
}

std::string checked_base_url(std::string url, const std::string& option) {
  const std::string given = url;
  while (url.ends_with('/')) url.pop_back();
  const std::size_t scheme = url.starts_with("http://") ? 7 : url.starts_with("https://") ? 8 : 0;
  const std::string host = url.substr(scheme, url.find('/', scheme) - scheme);
  const std::size_t colon = host.rfind(':');
  const bool has_port = colon != host.npos && host.find(']', colon) == host.npos;
  const long port = has_port ? std::strtol(host.c_str() + colon + 1, nullptr, 10) : 1;
  if (scheme == 0 || url.size() <= scheme || host.empty() || colon == 0 || port < 1 ||
      port > 65'535 || url.find_first_of(" \t\r\n") != url.npos) {
    fail("{} \"{}\" is not a web address; use the form {}", option, one_line(given, 80),
         kEliaBaseUrl);
  }
  return url;
}

std::optional<fs::path> header_in_tree_around(const fs::path& folder) {
  for (fs::path at = folder; !at.empty(); at = at.parent_path()) {
    const fs::path header = at / "edge" / "generated" / "student_weights.h";
    if (fs::exists(header) && fs::exists(at / "edge" / "CMakeLists.txt")) return header;
    if (at == at.root_path()) break;
  }
  return std::nullopt;
}

fs::path header_to_replace() {
  std::error_code error;
  if (const auto header = header_in_tree_around(fs::current_path())) return shortened(*header);
  const fs::path program = fs::read_symlink("/proc/self/exe", error);
  if (const auto header = header_in_tree_around(program.parent_path())) return shortened(*header);
  fail(
      "no source tree with edge/generated/student_weights.h around {} or {}; change to it, or name "
      "the header with --out",
      fs::current_path().string(), program.string());
}

}  // namespace bess
