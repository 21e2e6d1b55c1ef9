// What every scenario did when somebody last looked, in one number each: every record of the edge,
// and every byte that it sent with its time. Expectations say what is right; this says what has
// changed, where nobody has an expectation.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tools/hil_runner/run/outcome.h"

namespace bess {

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
