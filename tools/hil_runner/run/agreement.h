// Comparisons of runs: a scenario in virtual and in wall time, by control cycle, a scenario without
// each of its parts, and with an earlier run.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "shared/host/json.h"
#include "tools/hil_runner/run/run_scenario.h"

namespace bess {

// Sensitivity of a scenario: runs without each of its parts must differ.

/// A finding for each part without effect and without excuse, and for each excuse of a part with an
/// effect. `outcome` is that of the whole scenario in virtual time. Throws Interrupted on a stop
/// request.
std::vector<Finding> judge_parts(const Outcome& outcome);

/// A control cycle with different orders in the two times.
struct OrderDifference {
  CycleRecord in_virtual;
  CycleRecord in_wall;
  /// Different input: "link", "price", "words", "meter", "battery", "before"; empty: equal inputs,
  /// which is an error.
  std::string met;
};

struct Agreement {
  std::string scenario;
  std::int64_t start_utc_s = 0;
  int cycles = 0;  ///< logged in both times
  std::vector<OrderDifference> otherwise{};
  std::string not_compared{};  ///< reason without a comparison; empty: compared

  /// All orders are equal or have different inputs; also true if this machine was too late.
  [[nodiscard]] bool holds() const;
};

/// Scenarios run in both times, in the order of the outcomes. Orders within a few watts are equal:
/// the energy of a quarter-hour depends on seconds.
std::vector<Agreement> agreements_of(const std::vector<Outcome>& outcomes);

/// One row per scenario, followed by its different orders.
std::string agreement_table(const std::vector<Agreement>& agreements);
Json agreement_json(const std::vector<Agreement>& agreements);
/// "1560 of 1563 control cycles of 60 scenarios have equal orders in both times, 3 differ with
/// different inputs, 0 with equal inputs"; empty if none ran in both.
std::string agreement_line(const std::vector<Agreement>& agreements);

// Signatures of runs, and a file with one for each scenario, of all records of the edge and all
// bytes that it sent. They detect changes that no expectation covers.

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
