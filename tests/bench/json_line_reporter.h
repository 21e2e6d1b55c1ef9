// Prints one JSON object a line and benchmark: name, value, unit, its counters, and peer and ratio
// where a peer was measured beside it in the same run; all are medians over the repetitions. A peer
// of benchmark "x" is registered as "x@peer-name", or is the counter "@peer-name" of x, whose label
// then says what the peer works with.
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
    std::vector<double> values;  ///< one a repetition
    std::string unit;
    std::string label;  ///< what the peer works with
    std::map<std::string, std::vector<double>> counters;
  };
  void add(const std::string& name, double value, const std::string& unit);
  std::vector<std::string> order_;
  std::map<std::string, Result> results_;
};

}  // namespace bess
