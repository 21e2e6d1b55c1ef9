#include "tools/hil_runner/judge/judge_context.h"

namespace bess {

namespace {

bool fits(const ExpectedCommand& wanted, const CommandInForce& c) {
  const int direction = c.power_w > 0 ? 1 : c.power_w < 0 ? -1 : 0;
  return wanted.direction.value_or(direction) == direction &&
         wanted.is_driven.value_or(c.is_driven) == c.is_driven;
}

void judge_reasons(JudgeContext& judging, const Expectation& expectation, const Window& span) {
  bool was_seen = expectation.reason.empty();
  std::string last = "nothing logged";
  for (const CycleRecord& cycle : judging.evidence.log) {
    const std::int64_t ns = cycle.utc_s * kSecondNs;
    if (ns < span.from_ns || ns >= span.to_ns) continue;
    last = reason_name(cycle.reason);
    was_seen = was_seen || last == expectation.reason;
    if (!expectation.no_reason.empty() && last == expectation.no_reason) {
      judging.find(ns, "another reason than " + expectation.no_reason, last);
    }
  }
  if (!was_seen)
    judging.find(span.from_ns, "the reason " + expectation.reason + " within its span", last);
}

/// Requires at least one plan, and all plans as expected.
void judge_plans(JudgeContext& judging, const Expectation& e, const Window& span) {
  bool is_any = false;
  for (const CycleRecord& cycle : judging.evidence.log) {
    const std::int64_t ns = cycle.utc_s * kSecondNs;
    const OutlookReport& seen = cycle.outlook;
    if (ns < span.from_ns || ns >= span.to_ns || seen.source == OutlookSource::kNone) continue;
    is_any = true;
    const int known = seen.known_quarter_hours;
    if (e.outlook == seen.source && known >= e.quarter_hours_min && known <= e.quarter_hours_max)
      continue;
    judging.find(ns, "the expected outlook",
                 fmt::format("{}, {} quarter-hours", outlook_source_name(seen.source), known));
  }
  if (!is_any) judging.find(span.from_ns, "a planned decision", "none");
}

}  // namespace

void judge_expectations(JudgeContext& judging) {
  int number = 0;
  for (const Expectation& expectation : judging.scenario.expectations) {
    judging.rule = fmt::format("expect {}", ++number);
    const std::int64_t from_ns = judging.scenario.utc_ns_at(expectation.span.from_min);
    const std::int64_t to_ns = expectation.span.to_min == kNeverMin
                                   ? judging.scenario.end_utc_ns()
                                   : judging.scenario.utc_ns_at(expectation.span.to_min);
    for (std::int64_t t = (from_ns + kStepNs - 1) / kStepNs * kStepNs; t < to_ns; t += kStepNs) {
      const CommandInForce command = judging.command_at(judging.settled_ns(t));
      if (!fits(expectation.command, command)) {
        judging.find(judging.settled_ns(t), expectation.command.text, watts(command));
      } else if (command.power_w < expectation.power_w_min ||
                 command.power_w > expectation.power_w_max) {
        judging.find(
            judging.settled_ns(t),
            fmt::format("{:g} to {:g} W", expectation.power_w_min, expectation.power_w_max),
            watts(command));
      }
    }
    judge_reasons(judging, expectation, {from_ns, to_ns});
    if (expectation.outlook != OutlookSource::kNone)
      judge_plans(judging, expectation, {from_ns, to_ns});
  }
}

void judge_end(JudgeContext& judging) {
  judging.rule = "end";
  if (judging.evidence.edge_exit_code != judging.scenario.exit_code) {
    judging.find(
        judging.scenario.end_utc_ns(),
        fmt::format("exit code {} of bess-edge", judging.scenario.exit_code),
        fmt::format("{} ({})", judging.evidence.edge_exit_code, judging.evidence.edge_last_line));
  }
  if (!judging.evidence.is_alive_at_end) {
    judging.find(judging.scenario.end_utc_ns(), "simulators that run until the end",
                 "one ended earlier");
  }
  if (judging.evidence.log.empty())
    judging.find(judging.scenario.end_utc_ns(), "a decision log", "none");
}

}  // namespace bess
