#include "edge/update/trial_run.h"

#include "edge/log/journal.h"
#include "edge/update/upgrade_trial.h"

namespace bess {

int UpgradeTrial::go_back(const std::string& reason) {
  lock();
  read();
  if (state_.previous.empty() || !machine_.store().has_whole(state_.previous)) {
    report(JournalLevel::kError, "no version before %s is kept in %s", state_.version.c_str(),
           machine_.store().folder().c_str());
    return 1;
  }
  if (!take({TrialPhase::kGoingBack, reason})) return 1;
  act();
  return state_.phase == TrialPhase::kRolledBack ? 0 : 1;
}

int UpgradeTrial::dismiss() {
  lock();
  read();
  const bool is_bad =
      state_.phase == TrialPhase::kRolledBack || state_.phase == TrialPhase::kFailed;
  if (!is_bad) {
    report(JournalLevel::kError, "there is nothing to dismiss%s%s",
           state_.phase == TrialPhase::kUnknown ? "" : ": the phase is ",
           trial_phase_name(state_.phase).data());
    return 1;
  }
  if (state_.version.empty()) state_.version = machine_.store().pointed("current");
  state_.phase = TrialPhase::kConfirmed;
  state_.refused.clear();
  state_.reason.clear();
  keep("dismissed", state_.version);
  std::string error;
  if (machine_.settle(state_, error)) return 0;
  report(JournalLevel::kError, "%s", error.c_str());
  return 1;
}

int UpgradeTrial::allow(const std::string& version) {
  lock();
  read();
  if (!is_refused(version)) {
    report(JournalLevel::kError, "%s was not rolled back here", version.c_str());
    return 1;
  }
  let_in(version);
  keep("allowed", version);
  return 0;
}

int run_trial_verb(const std::string& verb, const std::string& argument) {
  struct Plain {
    const char* name;
    int (UpgradeTrial::*run)();
  };
  struct Argued {
    const char* name;
    int (UpgradeTrial::*run)(const std::string&);
    const char* needs;
  };
  constexpr Plain kPlain[] = {{"begin", &UpgradeTrial::begin},
                              {"supervise", &UpgradeTrial::supervise},
                              {"look", &UpgradeTrial::look},
                              {"recover", &UpgradeTrial::recover},
                              {"dismiss", &UpgradeTrial::dismiss}};
  constexpr Argued kArgued[] = {
      {"announce", &UpgradeTrial::announce, "a version"},
      {"withdraw", &UpgradeTrial::withdraw, "a version"},
      {"allow", &UpgradeTrial::allow, "a version"},
      {"go-back", &UpgradeTrial::go_back, "a reason, which the history keeps"}};
  UpgradeTrial trial;
  for (const Plain& known : kPlain) {
    if (verb == known.name && argument.empty()) return (trial.*known.run)();
  }
  for (const Argued& known : kArgued) {
    if (verb != known.name) continue;
    if (!argument.empty()) return (trial.*known.run)(argument);
    report(JournalLevel::kError, "trial %s needs %s", known.name, known.needs);
    return 2;
  }
  report(JournalLevel::kError, "unknown trial %s (see bess-edge trial --help)", verb.c_str());
  return 2;
}

}  // namespace bess
