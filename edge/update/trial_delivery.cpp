#include "edge/update/upgrade_trial.h"

#include <utility>
#include <vector>

#include "edge/log/journal.h"
#include "edge/update/texts.h"
#include "edge/update/trial_cycles.h"
#include "edge/update/version_proof.h"
#include "shared/host/text.h"

namespace bess {

/// Before dpkg unpacks anything.
int UpgradeTrial::announce(const std::string& version) {
  lock();
  read();
  if (is_refused(version)) {
    report(JournalLevel::kError, "%s was rolled back here%s%s; bess-edge trial allow %s lets it in",
           version.c_str(), state_.refused == version ? ": " : "",
           state_.refused == version ? state_.reason.c_str() : "", version.c_str());
    return 1;
  }
  state_.announced = version;
  if (!is_on_trial() && state_.phase != TrialPhase::kGoingBack) {
    if (state_.version.empty()) state_.version = machine_.store().pointed("current");
    state_.phase = TrialPhase::kUpgrading;
    state_.since_utc = since_now();
    state_.elapsed_s = 0;
  }
  return write() ? 0 : 1;
}

/// dpkg could not bring what it announced, and has what it had: no fault of that version, which may
/// come again.
int UpgradeTrial::withdraw(const std::string& version) {
  lock();
  read();
  const bool was_too_late = state_.phase == TrialPhase::kRolledBack && is_unended(version);
  if (state_.announced != version && !was_too_late) return 0;
  state_.announced.clear();
  if (was_too_late) {
    state_.refused.clear();
    state_.reason.clear();
  }
  if (state_.phase == TrialPhase::kUpgrading || was_too_late) {
    state_.phase = phase_without_announcement(state_);
  }
  return keep("withdrawn", version) ? 0 : 1;
}

/// dpkg has delivered; what runs is another version until this one is proved.
int UpgradeTrial::begin() {
  lock();
  read();
  const VersionStore& store = machine_.store();
  const std::string announced = std::exchange(state_.announced, "");
  const std::string version = certificate_fact(store.delivery(), "version");
  if (version.empty()) return keep_out(announced, "it has no certificate that can be read");
  if (!announced.empty() && announced != version) {
    return keep_out(announced, joined({"its certificate is of version ", version}));
  }
  const std::string running = store.pointed("current");
  const std::string confirmed = store.pointed("confirmed");
  std::string error;
  const VersionStore::Kept kept = store.keep(version, store.delivery(), error);
  if (kept == VersionStore::Kept::kNoRoom) {  // no fault of the version's: dpkg may try again
    report(JournalLevel::kError, "%s; what runs stays; then dpkg --configure -a", error.c_str());
    return 1;
  }
  const bool is_let_in =
      kept == VersionStore::Kept::kWhole &&
      is_proved({store.folder_of(version), machine_.settings(), machine_.share()}, error);
  if (!is_let_in) return keep_out(version, error);
  if (version == confirmed) return confirm_again(version);
  count_version_before(running, version);
  state_.phase = TrialPhase::kTrying;
  state_.version = version;
  state_.previous = store.has_whole(confirmed) ? confirmed : "";
  state_.since_utc = since_now();
  state_.reason.clear();
  state_.boot.clear();
  state_.boots = 0;
  if (!keep("trying", version) || !machine_.settle(state_, error)) {
    report(JournalLevel::kError, "%s is not handed over to: %s", version.c_str(), error.c_str());
    return 1;
  }
  // A version that has not confirmed itself is stopped: its order does not stay in force.
  const bool keeps_order = running == confirmed && !running.empty();
  state_.is_handed_over = machine_.hand_over(keeps_order);
  write();
  store.reserve();
  return 0;
}

/// What runs goes on; dpkg is content, because nothing runs from where it unpacked.
int UpgradeTrial::keep_out(const std::string& version, const std::string& why) {
  const std::string running = machine_.store().pointed("current");
  if (state_.phase == TrialPhase::kUpgrading || state_.phase == TrialPhase::kConfirmed ||
      state_.phase == TrialPhase::kUnknown) {
    state_.phase = running.empty() ? TrialPhase::kFailed : TrialPhase::kRolledBack;
    state_.version = running;
  }
  refuse_version(version, why);
  report(JournalLevel::kError, "%s is not let in: %s%s%s", version.c_str(), why.c_str(),
         running.empty() ? "" : "; what runs stays: ", running.c_str());
  keep("refused", version);
  machine_.pin(state_.refused_all);
  std::string error;
  if (!machine_.settle(state_, error)) report(JournalLevel::kError, "%s", error.c_str());
  machine_.store().prune({state_.version, state_.previous});
  return running.empty() ? 1 : 0;
}

/// The version that has confirmed itself already, by the same bytes.
int UpgradeTrial::confirm_again(const std::string& version) {
  const bool runs = machine_.store().pointed("current") == version;
  state_.phase = TrialPhase::kConfirmed;
  state_.version = version;
  state_.refused.clear();
  state_.reason.clear();
  if (state_.previous == version) state_.previous.clear();
  state_.is_handed_over = runs;
  keep("confirmed", version);
  if (runs) {  // as a link; the process may have ended with a removal, or be of a package since
    state_.is_handed_over = machine_.hand_over(true);
  } else {
    start_other();
  }
  write();
  return 0;
}

/// Its last cycles: what a new one must equal, and which trouble is not the new one's.
/// While one is on trial already, the bar stays that of the version before both.
void UpgradeTrial::count_version_before(const std::string& running, const std::string& next) {
  const TrialLimits limits = machine_.limits();
  std::vector<TrialCycle> before;
  std::string mark;
  if (!running.empty()) {
    const bool must_write = wants_control(machine_.settings());
    const std::string program = machine_.store().program_of(running);
    std::int64_t number = INT64_MAX;
    for (const SeenCycle& seen : last_cycles(program, machine_.settings(), must_write)) {
      if (seen.number <= number) before.clear();  // of another process, and maybe another version
      number = seen.is_cycle ? seen.number : INT64_MAX;
      if (seen.is_cycle) before.push_back(seen.cycle);
      if (seen.name == state_.mark) before.clear();  // until then it was on trial, or another was
      mark = seen.name;
    }
  }
  restart_account(state_);
  state_.mark = mark;
  // A program that cannot tell must not make its cycles those of the next one.
  if (mark.empty()) mark_newest_cycle(machine_.store().program_of(next));
  state_.window.clear();
  state_.bad_cause.clear();
  state_.good_cycles = state_.passed = state_.worse = 0;
  if (running != machine_.store().pointed("confirmed") && state_.needed_cycles > 0) return;
  state_.shared.clear();
  state_.needed_cycles = needed_good_cycles(before, limits);
  if (!before.empty()) share(state_, before.back().cause);
}

}  // namespace bess
