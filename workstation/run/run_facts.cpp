#include "workstation/run/run_facts.h"

#include <fmt/core.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <fstream>
#include <iterator>
#include <optional>

#include "shared/crc32.h"
#include "shared/host/file.h"
#include "shared/host/json.h"
#include "shared/host/made/build_info.h"
#include "shared/host/shell_word.h"
#include "shared/utc_text.h"
#include "workstation/chain/learning_class.h"

namespace bess {
namespace {

namespace fs = std::filesystem;

/// Bytes as they lie on the disk, gzip or not; none when it cannot be read.
std::optional<std::string> bytes_of(const fs::path& path) {
  std::ifstream file(path, std::ios::binary);
  if (!file || fs::is_directory(path)) return std::nullopt;
  return std::string(std::istreambuf_iterator<char>(file), {});
}

/// Of this process, as it was given.
std::string command_line() {
  const std::string words = bytes_of("/proc/self/cmdline").value_or("");
  std::string line;
  for (std::size_t at = 0; at < words.size();) {
    const std::string word = words.substr(at, words.find('\0', at) - at);
    if (at > 0) line += ' ';
    line += shell_word(at == 0 ? fs::path(word).filename().string() : word);
    at += word.size() + 1;
  }
  return line;
}

std::string host_name() {
  char name[256] = {};
  return gethostname(name, sizeof name - 1) == 0 ? name : "unknown";
}

/// "teacher 12.1 s, ..." of times.json; empty without one.
std::string stage_times(const fs::path& path) {
  std::string text;
  if (!fs::exists(path)) return text;
  const Json times = Json::parse(read_file(path));
  for (const JsonValue stage : times.value()) {
    const auto seconds = stage["seconds"].number();
    if (!seconds) continue;
    text += fmt::format("{}{} {:.1f} s", text.empty() ? "" : ", ", stage.key(), *seconds);
  }
  return text;
}

/// "FILE: crc32 1234abcd, 4711 bytes"
std::string prices_text(const RunFolder& folder) {
  const Json run = Json::parse(read_file(folder.path / "run.json"));
  const fs::path named = run.value()["prices"].text_or("");
  const fs::path path = named.has_parent_path() ? named : folder.path / named;
  const std::optional<std::string> bytes = bytes_of(path);
  if (named.empty()) return "not named in run.json";
  if (!bytes) return named.string() + ": is no longer there";
  Crc32 crc;
  crc.add_bytes(bytes->data(), bytes->size());
  return fmt::format("{}: crc32 {:08x}, {} bytes", path.filename().string(), crc.value(),
                     bytes->size());
}

std::string span_text(const MarketSteps& market) {
  const auto days = [&](Split split) { return market.days_of(split).size(); };
  return fmt::format("{} to {}: {} training, {} validation and {} test days",
                     market.days.front().date(), market.days.back().date(), days(Split::kTrain),
                     days(Split::kValidation), days(Split::kTest));
}

}  // namespace

std::vector<Fact> making_facts(const RunFolder& folder) {
  std::vector<Fact> facts;
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    facts.push_back({"date", std::string(utc_text(std::strtoll(epoch, nullptr, 10)).view())});
    return facts;
  }
  facts.push_back({"date", std::string(utc_text(std::time(nullptr)).view())});
  facts.push_back({"host", host_name()});
  facts.push_back({"command", command_line()});
  facts.push_back(
      {"computed for", fmt::format("{:.1f} CPU seconds, this command until here",
                                   static_cast<double>(std::clock()) / CLOCKS_PER_SEC)});
  const std::string times = stage_times(folder.path / "times.json");
  if (!times.empty()) facts.push_back({"stages", times});
  return facts;
}

std::string program_text() { return fmt::format("bess-train {}, {}", BESS_VERSION, build_line()); }

std::vector<Fact> run_facts(const RunConfig& config, const MarketSteps& market,
                            const RunFolder& folder) {
  std::vector<Fact> facts = making_facts(folder);
  const int delay_min = config.market.observation_delay_min;
  facts.push_back({"program", program_text()});
  facts.push_back({"prices", prices_text(folder)});
  facts.push_back({"span", span_text(market)});
  facts.push_back(
      {"observation delay", fmt::format("{} minute{}", delay_min, delay_min == 1 ? "" : "s")});
  facts.push_back({"settlement", config.market.settlement == Settlement::kMinute
                                     ? "each minute by its own quarter-hour"
                                     : "each step by the quarter-hour in which it starts"});
  facts.push_back({"keys changed", changed_keys_text(config)});
  facts.push_back(
      {"seed, threads", fmt::format("{}, {}", config.train.seed, config.train.threads)});
  return facts;
}

}  // namespace bess
