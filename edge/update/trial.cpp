#include "edge/update/trial.h"

#include <algorithm>
#include <iterator>

#include "edge/update/texts.h"

namespace bess {
namespace {

constexpr std::string_view kPhaseNames[] = {"",          "upgrading",  "trying",      "comparing",
                                            "confirmed", "going_back", "rolled_back", "failed",
                                            "hidden"};
constexpr std::string_view kCauseNames[] = {"none", "no_start", "no_cycle", "trip",  "price",
                                            "link", "alarm",    "off_grid", "clock", "hold"};
static_assert(std::size(kPhaseNames) == static_cast<std::size_t>(TrialPhase::kHidden) + 1);
static_assert(std::size(kCauseNames) == kTrialCauseCount);

void push(TrialState& state, char cycle, const TrialLimits& limits) {
  state.window += cycle;
  const auto most = static_cast<std::size_t>(limits.window());
  if (state.window.size() > most) state.window.erase(0, state.window.size() - most);
  state.good_cycles = std::count(state.window.begin(), state.window.end(), '1');
}

/// A trip stays until a person has looked, and a hold until its end, whichever version runs.
bool is_comparable(TrialCause cause) {
  return cause != TrialCause::kNone && cause != TrialCause::kTrip && cause != TrialCause::kHold;
}

std::string what_is_seen(TrialCause cause) {
  if (cause == TrialCause::kNoStart) return "it does not stay up";
  if (cause == TrialCause::kNoCycle) return "it has no cycle";
  return joined({"its cycles are lost by ", trial_cause_name(cause)});
}

TrialStep stay(const TrialState& state) { return {state.phase, "", TrialCause::kNone}; }

/// Where there is a version before: to it. Else this one stays, and that is told.
TrialStep give_up(const TrialState& state, std::string reason) {
  const bool has_way_back = !state.previous.empty();
  return {has_way_back ? TrialPhase::kGoingBack : TrialPhase::kFailed, std::move(reason)};
}

/// Not give_up yet: the version before takes over, and shows whether it fares better.
TrialStep compare(const TrialState& state, TrialCause cause) {
  if (state.previous.empty()) return give_up(state, what_is_seen(cause));
  return {TrialPhase::kComparing, what_is_seen(cause), cause};
}

TrialStep next_of_trial(const TrialState& state, const TrialUnit& unit, const TrialLimits& limits) {
  if (state.good_cycles >= state.needed_cycles && state.needed_cycles > 0) {
    return {TrialPhase::kConfirmed, ""};
  }
  const std::string good = joined({std::to_string(state.good_cycles), " of ",
                                   std::to_string(state.needed_cycles), " good cycles"});
  if (state.boots > limits.boots) {
    return give_up(state, joined({"the machine was started ", std::to_string(state.boots),
                                  " times before it confirmed"}));
  }
  const bool does_not_start = unit.has_failed || unit.restarts > limits.restarts;
  if (does_not_start && !is_shared(state, TrialCause::kNoStart)) {
    return compare(state, TrialCause::kNoStart);
  }
  // While the order of the version before is still in force, which that one then takes over.
  if (!state.is_fresh && state.elapsed_s >= limits.first_cycle_s && !state.previous.empty()) {
    return compare(state, TrialCause::kNoCycle);
  }
  const TrialCause cause = trial_cause_of(state.bad_cause);
  if (state.bad_run >= kStandingCycles && cause != TrialCause::kNone) {
    if (!is_comparable(cause)) return give_up(state, what_is_seen(cause));
    if (!state.previous.empty()) return compare(state, cause);
  }
  if (state.rest_s >= limits.deadline_s && !state.previous.empty()) {
    return compare(state, TrialCause::kNone);
  }
  if (state.elapsed_s >= limits.deadline_s) {
    return give_up(state, joined({good, " in ", std::to_string(state.elapsed_s), " s"}));
  }
  return stay(state);
}

TrialStep next_of_comparison(const TrialState& state, const TrialUnit& unit,
                             const TrialLimits& limits) {
  const TrialCause cause = trial_cause_of(state.bad_cause);
  // It had that trouble as well, and has it no more: the site's, and over.
  if (state.other > 0 && state.same > 0 && state.passed < kPassedMax) {
    return {TrialPhase::kTrying, ""};
  }
  // It did not have it: by chance, the first time.
  const bool may_be_chance =
      cause != TrialCause::kNone && cause != TrialCause::kNoStart && state.worse + 1 < kWorseMax;
  if (state.other > 0 && state.same == 0 && may_be_chance) {
    return {TrialPhase::kTrying, ""};
  }
  if (state.other > 0) {
    return {TrialPhase::kGoingBack, joined({state.reason, "; not so ", state.previous})};
  }
  const bool does_not_start = unit.has_failed || unit.restarts > limits.restarts;
  if (state.same >= kSameCycles || does_not_start) {
    return {TrialPhase::kTrying, "", does_not_start ? TrialCause::kNoStart : cause};
  }
  if (state.elapsed_s >= limits.deadline_s) {
    return {TrialPhase::kGoingBack,
            joined({state.reason, "; ", state.previous, " has no cycle either"})};
  }
  return stay(state);
}

}  // namespace

std::string_view trial_phase_name(TrialPhase phase) {
  return kPhaseNames[static_cast<std::size_t>(phase)];
}

TrialPhase trial_phase_of(std::string_view name) {
  const auto* const found = std::find(std::begin(kPhaseNames), std::end(kPhaseNames), name);
  return found == std::end(kPhaseNames) ? TrialPhase::kUnknown
                                        : static_cast<TrialPhase>(found - kPhaseNames);
}

std::string_view trial_cause_name(TrialCause cause) {
  return kCauseNames[static_cast<std::size_t>(cause)];
}

TrialCause trial_cause_of(std::string_view name) {
  const auto* const found = std::find(std::begin(kCauseNames), std::end(kCauseNames), name);
  return found == std::end(kCauseNames) ? TrialCause::kNone
                                        : static_cast<TrialCause>(found - kCauseNames);
}

std::int64_t needed_good_cycles(const std::vector<TrialCycle>& before, const TrialLimits& limits) {
  const auto window = static_cast<std::size_t>(limits.window());
  if (before.size() < window) return limits.good_cycles;  // too few to compare with
  const std::int64_t good =
      std::count_if(before.end() - static_cast<std::ptrdiff_t>(window), before.end(),
                    [](const TrialCycle& cycle) { return cycle.is_good; });
  // Below half of them something was away, which says nothing of the version.
  if (2 * good < limits.window()) return limits.good_cycles;
  return std::min(std::max(good - 1, std::min(good, limits.good_cycles)), limits.window());
}

bool is_shared(const TrialState& state, TrialCause cause) {
  if (cause == TrialCause::kNone) return false;
  const std::string all = joined({",", state.shared, ","});
  return all.find(joined({",", trial_cause_name(cause), ","})) != std::string::npos;
}

void share(TrialState& state, TrialCause cause) {
  if (cause == TrialCause::kNone || is_shared(state, cause)) return;
  if (!state.shared.empty()) state.shared += ',';
  state.shared.append(trial_cause_name(cause));
}

void count_cycle(TrialState& state, const TrialCycle& cycle, const TrialLimits& limits) {
  const TrialCause awaited = trial_cause_of(state.bad_cause);
  if (state.phase == TrialPhase::kComparing) {
    const bool is_same = awaited == TrialCause::kNone ? !cycle.is_good : cycle.cause == awaited;
    ++(is_same ? state.same : state.other);
    return;
  }
  for (std::int64_t i = 0; i < std::min(cycle.missed_ticks, limits.window()); ++i) {
    push(state, '0', limits);
  }
  if (cycle.is_good) {
    push(state, '1', limits);
    state.shared.clear();
    state.bad_cause.clear();
    state.bad_run = state.rest_s = 0;
  } else if (cycle.cause == TrialCause::kHold || is_shared(state, cycle.cause)) {
    state.bad_run = 0;
    state.bad_cause = trial_cause_name(cycle.cause);
  } else {
    push(state, '0', limits);
    const bool goes_on = trial_cause_of(state.bad_cause) == cycle.cause;
    state.bad_run = goes_on ? state.bad_run + 1 : 1;
    state.bad_cause = trial_cause_name(cycle.cause);
  }
}

void count_restarts(TrialState& state, const TrialUnit& unit) {
  const TrialCause awaited = trial_cause_of(state.bad_cause);
  const bool is_awaited = state.phase == TrialPhase::kComparing &&
                          (awaited == TrialCause::kNoStart || awaited == TrialCause::kNoCycle);
  if (is_awaited && unit.restarts > 0 && state.same == 0) state.same = 1;
}

void count_time(TrialState& state, const TrialUnit& unit, std::int64_t passed_s) {
  if (unit.is_stopped && state.phase != TrialPhase::kUpgrading) return;
  const TrialCause cause = trial_cause_of(state.bad_cause);
  const bool is_in_trial = state.phase == TrialPhase::kTrying;
  const bool waits_for_start = is_shared(state, TrialCause::kNoStart);
  // With no version before to ask, the site has the benefit of the doubt.
  const bool is_doubtful =
      state.previous.empty() && state.bad_run >= kStandingCycles && is_comparable(cause);
  const bool rests = is_in_trial && (waits_for_start || is_doubtful || is_shared(state, cause));
  const bool is_held = is_in_trial && state.bad_run == 0 && cause == TrialCause::kHold;
  if (is_held || (rests && cause == TrialCause::kTrip)) return;
  (rests ? state.rest_s : state.elapsed_s) += passed_s;
}

TrialStep next_phase(const TrialState& state, const TrialUnit& unit, const TrialLimits& limits) {
  switch (state.phase) {
    case TrialPhase::kUpgrading:
      if (state.elapsed_s < limits.upgrade_s) break;
      return {TrialPhase::kRolledBack, joined({"dpkg did not end its installation in ",
                                               std::to_string(state.elapsed_s), " s"})};
    case TrialPhase::kTrying:
      return unit.is_stopped ? stay(state) : next_of_trial(state, unit, limits);
    case TrialPhase::kComparing:
      return unit.is_stopped ? stay(state) : next_of_comparison(state, unit, limits);
    case TrialPhase::kUnknown:
    case TrialPhase::kConfirmed:
    case TrialPhase::kGoingBack:
    case TrialPhase::kRolledBack:
    case TrialPhase::kFailed:
    case TrialPhase::kHidden:
      break;
  }
  return stay(state);
}

void restart_account(TrialState& state) {
  state.mark.clear();
  state.elapsed_s = state.rest_s = 0;
  state.bad_run = state.same = state.other = 0;
  state.restarts = -1;
  state.is_fresh = state.is_handed_over = false;
}

TrialPhase phase_without_announcement(const TrialState& state) {
  if (state.version.empty()) return TrialPhase::kUnknown;
  if (!state.refused.empty()) return TrialPhase::kRolledBack;
  return state.reason.empty() ? TrialPhase::kConfirmed : TrialPhase::kFailed;
}

std::string running_version(const TrialState& state) {
  const bool is_old =
      state.phase == TrialPhase::kGoingBack || state.phase == TrialPhase::kComparing;
  // dpkg's half work touches nothing that runs.
  if (state.phase == TrialPhase::kUpgrading || state.phase == TrialPhase::kUnknown) return "";
  return is_old ? state.previous : state.version;
}

std::string judging_version(const TrialState& state) {
  switch (state.phase) {
    case TrialPhase::kConfirmed:
    case TrialPhase::kRolledBack:
      return state.version;
    case TrialPhase::kTrying:
    case TrialPhase::kComparing:
    case TrialPhase::kGoingBack:
      return state.previous;
    case TrialPhase::kUnknown:
    case TrialPhase::kUpgrading:
    case TrialPhase::kFailed:
    case TrialPhase::kHidden:
      break;
  }
  return "";
}

}  // namespace bess
