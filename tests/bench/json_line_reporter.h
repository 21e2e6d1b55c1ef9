// Reporter that prints one JSON object per line and benchmark: name, value, unit, counters, and
// peer and ratio if a peer was measured in the same run. All are medians over the repetitions. The
// peer of benchmark "x" is registered as "x@peer-name", or is the counter "@peer-name" of x, whose
// label then names the peer's library.
#pragma once

#include <benchmark/benchmark.h>

#include <map>
#include <string>
#include <vector>

namespace bess {

class JsonLineReporter final : public benchmark::BenchmarkReporter {
 public:
  bool ReportContext(const Context&) override { return true; }
  void ReportRuns(const std::vector<Run>& runs) override;
  void Finalize() override;

 private:
  struct Result {
    std::vector<double> values;  ///< one per repetition
    std::string unit;
    std::string label;  ///< library of the peer
    std::map<std::string, std::vector<double>> counters;
  };
  void add(const std::string& name, double value, const std::string& unit);
  std::vector<std::string> order_;
  std::map<std::string, Result> results_;
};

}  // namespace bess
