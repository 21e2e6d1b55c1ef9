// scenario_metrics FOLDER: each scenario in virtual time, as the metrics that a scrape once a
// minute would have seen, with their times: lines of Prometheus' text that VictoriaMetrics imports.
// All begin at the same instant, each an `instance` of its own. A file of metrics stays when its
// writer has died, so the last text goes on to the end of the scenario.
#include <charconv>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "edge/log/run_status.h"
#include "shared/local_time.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {
namespace {

constexpr std::int64_t kBegin = 1'767'225'600;  // 2026-01-01T00:00:00Z
constexpr std::int64_t kScrape_s = 60;
constexpr std::int64_t kLongest_s = 86'400;

/// "name{a="b"} 1" -> "name{instance="x",job="bess",a="b"} 1 1767225600000".
void print_labelled(std::string_view line, const std::string& instance, std::int64_t utc_s) {
  const std::size_t name_end = line.find_first_of("{ ");
  const bool has_labels = line[name_end] == '{';
  const std::size_t rest = has_labels ? name_end + 1 : name_end;
  std::printf("%.*s{instance=\"%s\",job=\"bess\"%s%.*s %lld\n", static_cast<int>(name_end),
              line.data(), instance.c_str(), has_labels ? "," : "}",
              static_cast<int>(line.size() - rest), line.data() + rest,
              static_cast<long long>(utc_s) * 1'000);
}

void print_scrape(std::string_view text, const std::string& instance, std::int64_t utc_s) {
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    if (!line.empty() && line[0] != '#') print_labelled(line, instance, utc_s);
    if (end == std::string_view::npos) break;
    text.remove_prefix(end + 1);
  }
}

void print_scenario(const Outcome& outcome) {
  const Scenario& scenario = outcome.scenario;
  const std::int64_t shift_s = kBegin - scenario.start_utc_s;
  const std::int64_t end =
      kBegin + std::min(kLongest_s, static_cast<std::int64_t>(60 * scenario.minutes));
  RunTotals totals;
  auto next = outcome.evidence.log.begin();
  for (std::int64_t now = kBegin; now <= end; now += kScrape_s) {
    for (; next != outcome.evidence.log.end() && next->utc_s + shift_s <= now; ++next) {
      CycleRecord record = *next;
      if (record.cycle <= totals.last.cycle) totals = {};  // another run counts anew
      record.utc_s += shift_s;
      totals.count(record);
    }
    if (totals.cycles == 0) continue;
    char storage[kMetricsBytes];
    TextBuffer text(storage);
    format_prometheus({.identity = {}, .totals = totals}, text);
    print_scrape(text.view(), scenario.name, now);
  }
}

int print_all(const std::filesystem::path& folder) {
  std::set<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() == ".toml") files.insert(entry.path());
  }
  for (const auto& file : files) {
    const Scenario scenario = read_scenario(file);
    if (!scenario.runs_virtual) continue;
    const Outcome outcome = run_scenario(scenario, true, {});
    if (!outcome.passed()) {
      std::fprintf(stderr, "%s: %s\n", file.c_str(), complaint(outcome).c_str());
      return 1;
    }
    print_scenario(outcome);
  }
  return 0;
}

}  // namespace
}  // namespace bess

int main(int argc, char** argv) {
  if (argc != 2) {
    std::fputs("usage: scenario_metrics FOLDER\n", stderr);
    return 2;
  }
  bess::set_market_time_zone();
  return bess::print_all(argv[1]);
}
