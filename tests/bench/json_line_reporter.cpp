#include "tests/bench/json_line_reporter.h"

#include <fmt/format.h>

#include <algorithm>

#include "tests/bench/registry.h"

namespace bess {
namespace {

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Name without Google Benchmark's suffixes ("/repeats:5", "/real_time").
std::string plain_name(const std::string& name) { return name.substr(0, name.find('/')); }

}  // namespace

std::vector<std::string>& benchmark_names() {
  static std::vector<std::string> names;
  return names;
}

void JsonLineReporter::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.error_occurred || run.run_type == Run::RT_Aggregate) continue;
    const std::string name = plain_name(run.benchmark_name());
    if (!results_.contains(name)) order_.push_back(name);
    Result& result = results_[name];
    // A benchmark that counts items is about their rate; any other about its time.
    const auto rate = run.counters.find("items_per_second");
    if (rate != run.counters.end()) {
      result.values.push_back(rate->second / 1e6);
      result.unit = "million/s";
    } else {
      result.values.push_back(run.GetAdjustedRealTime());
      result.unit = benchmark::GetTimeUnitString(run.time_unit);
    }
  }
}

void JsonLineReporter::Finalize() {
  for (const std::string& name : order_) {
    if (name.find('@') != std::string::npos) continue;
    const double value = median(results_[name].values);
    fmt::print(R"({{"name": "{}", "value": {:.6g}, "unit": "{}")", name, value,
               results_[name].unit);
    const auto peer = std::ranges::find_if(
        order_, [&](const std::string& other) { return other.starts_with(name + "@"); });
    if (peer != order_.end()) {
      const double peer_value = median(results_[*peer].values);
      const bool rate = results_[name].unit == "million/s";
      fmt::print(R"(, "peer": "{}", "peer_value": {:.6g}, "ratio": {:.4g})",
                 peer->substr(name.size() + 1), peer_value,
                 rate ? value / peer_value : peer_value / value);
    }
    fmt::print("}}\n");
  }
}

}  // namespace bess
