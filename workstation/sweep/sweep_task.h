// One task of a sweep: its number and what sets it apart from all others. A line of tasks.tsv holds
// one, so that a task reads its own line and nobody counts axes twice.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "workstation/base/answer.h"

namespace bess {

/// Names among a task's settings that are no keys of the configuration.
namespace setting {
inline constexpr const char* kSeed = "seed";
inline constexpr const char* kFold = "fold";    ///< a month (run/run_backtest.h)
inline constexpr const char* kRules = "rules";  ///< the stem of a file in the sweep's rules/
inline constexpr const char* kClass = "class";  ///< of sites that share the student (sites.h)
}  // namespace setting

struct SweepTask {
  int number = 0;    ///< from 1
  Entries settings;  ///< those above, then "section.key" and its value as TOML writes it

  [[nodiscard]] std::string value(std::string_view name) const;  ///< empty: it has none
  [[nodiscard]] Entries without_seed_and_fold() const;
};

/// "seed=1 <tab> distil.fidelity=2": the same settings give the same text.
std::string settings_text(const Entries& settings);
/// For people: "seed 1, distil.fidelity 2".
std::string settings_shown(const Entries& settings);

std::string format_tasks(const std::vector<SweepTask>& tasks);
/// Throws UserError naming `name` and the line.
std::vector<SweepTask> parse_tasks(std::string_view text, const std::string& name);

}  // namespace bess
