#include "tools/hil_runner/judge/judge.h"

#include <algorithm>

#include "tools/hil_runner/judge/bench.h"

namespace bess {

std::vector<Finding> judge(const Trial& trial) {
  Bench bench(trial);
  const auto is_judged = [&](const char* name) {
    const auto& judged = trial.scenario.invariants;
    return std::ranges::find(judged, name) != judged.end();
  };
#define BESS_ROW(name, text) \
  if (is_judged(#name)) {    \
    bench.rule = #name;      \
    judge_##name(bench);     \
  }
  BESS_RULES(BESS_ROW)
#undef BESS_ROW
  judge_expectations(bench);
  judge_end(bench);
  return bench.findings();
}

}  // namespace bess
