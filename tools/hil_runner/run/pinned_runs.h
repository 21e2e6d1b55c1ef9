// Signatures of runs, and a file with one for each scenario, of all records of the edge and all
// bytes that it sent. They detect changes that no expectation covers.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {

// Checksum of a run: battery trace, and inputs and decisions of the edge.

/// Differs for runs with any difference in the evidence.
std::uint64_t signature_of(const Evidence& evidence);

class PinnedRuns {
 public:
  /// `path`: lines with name and number of a scenario. Throws if unreadable. With `renews`, `write`
  /// updates the file and there are no findings.
  PinnedRuns(const std::string& path, bool renews);

  /// Finding for a run in virtual time.
  [[nodiscard]] std::vector<Finding> judge(const Outcome& outcome);
  void write() const;

 private:
  std::string path_;
  bool renews_;
  std::map<std::string, std::string> numbers_;
};

}  // namespace bess
