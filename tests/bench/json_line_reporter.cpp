#include "tests/bench/json_line_reporter.h"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "tests/bench/registry.h"

namespace bess {
namespace {

constexpr const char* kRate = "items_per_second";

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

/// Ratio to the peer, above 1 if ours is better. Median of the ratios of each repetition: where the
/// two alternate, a change of the machine's pace affects both.
double median_ratio(const std::vector<double>& values, const std::vector<double>& peers,
                    bool is_rate) {
  std::vector<double> ratios;
  for (std::size_t i = 0; i < values.size(); ++i) {
    ratios.push_back(is_rate ? values[i] / peers[i] : peers[i] / values[i]);
  }
  return median(std::move(ratios));
}

/// Name without Google Benchmark's suffixes ("/repeats:5", "/real_time").
std::string plain_name(const std::string& name) { return name.substr(0, name.find('/')); }

}  // namespace

std::vector<std::string>& benchmark_names() {
  static std::vector<std::string> names;
  return names;
}

void JsonLineReporter::add(const std::string& name, double value, const std::string& unit) {
  if (!results_.contains(name)) order_.push_back(name);
  results_[name].values.push_back(value);
  results_[name].unit = unit;
}

void JsonLineReporter::ReportRuns(const std::vector<Run>& runs) {
  for (const Run& run : runs) {
    if (run.error_occurred || run.run_type == Run::RT_Aggregate) continue;
    const std::string name = plain_name(run.benchmark_name());
    const std::string time_unit = benchmark::GetTimeUnitString(run.time_unit);
    // A benchmark that counts items is compared by rate, any other by time.
    const auto rate = run.counters.find(kRate);
    if (rate != run.counters.end()) {
      add(name, rate->second / 1e6, "million/s");
    } else {
      add(name, run.GetAdjustedRealTime(), time_unit);
    }
    results_[name].label = run.report_label;
    for (const auto& [counter, value] : run.counters) {
      if (counter.starts_with("@")) {
        add(name + counter, value, time_unit);
      } else if (counter != kRate) {
        results_[name].counters[counter].push_back(value);
      }
    }
  }
}

void JsonLineReporter::Finalize() {
  for (const std::string& name : order_) {
    if (name.find('@') != std::string::npos) continue;
    const double value = median(results_[name].values);
    fmt::print(R"({{"name": "{}", "value": {:.6g}, "unit": "{}")", name, value,
               results_[name].unit);
    for (const auto& [counter, values] : results_[name].counters) {
      fmt::print(R"(, "{}": {:.4g})", counter, median(values));
    }
    const auto peer = std::ranges::find_if(
        order_, [&](const std::string& other) { return other.starts_with(name + "@"); });
    if (peer != order_.end()) {
      const std::vector<double>& peers = results_[*peer].values;
      const double peer_value = median(peers);
      const bool is_rate = results_[name].unit == "million/s";
      // A peer that runs separately may have fewer repetitions.
      const double ratio = peers.size() == results_[name].values.size()
                               ? median_ratio(results_[name].values, peers, is_rate)
                               : median_ratio({value}, {peer_value}, is_rate);
      if (std::isnan(peer_value)) {
        fmt::print(R"(, "peer": null)");
      } else {
        fmt::print(R"(, "peer": "{}", "peer_value": {:.6g}, "ratio": {:.4g})",
                   peer->substr(name.size() + 1), peer_value, ratio);
        const std::string& label = results_[name].label;
        if (!label.empty()) fmt::print(R"(, "peer_works_with": "{}")", label);
      }
    }
    fmt::print("}}\n");
  }
}

}  // namespace bess
