// Signatures of runs, and the file that pins one for each scenario: every record of the edge, and
// every byte that it sent with its time. They show a change that no expectation covers.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/run/outcome.h"

namespace bess {

// One number for a run: of every bit of what the battery did, and of what the edge saw and decided.

/// Two runs that differ in it anywhere have two signatures.
std::uint64_t signature_of(const Evidence& evidence);

/// Of every field of the edge's records, and of every byte that it sent with its time. What the
/// battery did follows from these.
std::uint64_t pinned_number_of(const Evidence& evidence);

class PinnedRuns {
 public:
  /// `path`: lines of a scenario's name and its number. Throws where it cannot be read. With
  /// `renews` it is written anew by `write`, and nothing is found.
  PinnedRuns(const std::string& path, bool renews);

  /// Of a run in virtual time.
  [[nodiscard]] std::vector<Finding> judge(const Outcome& outcome);
  void write() const;

 private:
  std::string path_;
  bool renews_;
  std::map<std::string, std::string> numbers_;
};

}  // namespace bess
