#include "tools/hil_runner/run/pinned_runs.h"

#include <fmt/core.h>

#include <fstream>

#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "tools/hil_runner/run/run_signature.h"

namespace bess {

PinnedRuns::PinnedRuns(const std::string& path, bool renews) : path_(path), renews_(renews) {
  std::ifstream file(path);
  if (!file && !renews) fail("{}: cannot be read; BESS_UPDATE_GOLDEN=1 writes it", path);
  for (std::string name, number; file >> name >> number;) numbers_[name] = number;
}

std::vector<Finding> PinnedRuns::judge(const Outcome& outcome) {
  const std::string number = fmt::format("{:016x}", pinned_number_of(outcome.evidence));
  std::string& pinned = numbers_[outcome.scenario.name];
  if (renews_) pinned = number;
  if (pinned == number) return {};
  return {{.rule = "pinned",
           .utc_s = outcome.scenario.start_utc_s,
           .expected = pinned.empty() ? "a line in " + path_ : "the run " + pinned + ", as before",
           .seen = fmt::format("the run {}; if this is meant: BESS_UPDATE_GOLDEN=1 renews {}",
                               number, path_)}};
}

void PinnedRuns::write() const {
  if (!renews_) return;
  std::string text;
  for (const auto& [name, number] : numbers_) text += fmt::format("{} {}\n", name, number);
  write_file(path_, text);
}

}  // namespace bess
