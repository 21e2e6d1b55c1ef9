// Prints one JSON object a line and benchmark: name, value, unit, and peer and ratio where a peer was
// measured beside it in the same run. A peer of benchmark "x" is registered as "x@peer-name".
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
  };
  std::vector<std::string> order_;
  std::map<std::string, Result> results_;
};

}  // namespace bess
