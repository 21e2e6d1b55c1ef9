#include "tools/hil_runner/judge/judge.h"

#include <algorithm>

#include "tools/hil_runner/judge/judge_context.h"

namespace bess {

std::vector<Finding> judge(const JudgedRun& judged_run) {
  JudgeContext judging(judged_run);
  const auto is_judged = [&](const char* name) {
    const auto& judged = judged_run.scenario.invariants;
    return std::ranges::find(judged, name) != judged.end();
  };
#define BESS_ROW(name, text) \
  if (is_judged(#name)) {    \
    judging.rule = #name;    \
    judge_##name(judging);   \
  }
  BESS_RULES(BESS_ROW)
#undef BESS_ROW
  judge_expectations(judging);
  judge_end(judging);
  return judging.findings();
}

}  // namespace bess
