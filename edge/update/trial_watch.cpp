#include "edge/update/upgrade_trial.h"

#include <time.h>
#include <unistd.h>

#include <utility>

#include "edge/log/journal.h"
#include "edge/update/texts.h"
#include "edge/update/trial_cycles.h"

namespace bess {
namespace {

std::int64_t uptime_s() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return now.tv_sec;
}

}  // namespace

bool UpgradeTrial::is_on_trial() const {
  return state_.phase == TrialPhase::kTrying || state_.phase == TrialPhase::kComparing;
}

void UpgradeTrial::mark_newest_cycle(const std::string& program) {
  for (const SeenCycle& seen : last_cycles(program, machine_.settings(), false)) {
    state_.mark = seen.name;
  }
}

/// Another version than before runs from here on: flip, stop, start. The version that has confirmed
/// itself is not stopped but hands its order over, and what runs already stays: a hand-over that
/// was broken off behind the flip. Nor is anything stopped for a link that cannot be flipped: tried
/// again.
void UpgradeTrial::start_other() {
  std::string error;
  if (!machine_.settle(state_, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return;
  }
  const std::string next = running_version(state_);
  const std::string runs = machine_.process_version();
  state_.is_handed_over = runs == next;
  if (state_.is_handed_over) return;
  const bool keeps_order = !runs.empty() && runs == state_.previous;
  if (!keeps_order) machine_.stop();
  mark_newest_cycle(machine_.store().program_of(next));
  state_.is_handed_over = keeps_order ? machine_.hand_over(true) : machine_.start();
}

/// False where the disk does not keep it: then nothing may be done by it.
bool UpgradeTrial::take(const TrialStep& step) {
  const std::string version = state_.version;
  const std::string ran = running_version(state_);
  switch (step.phase) {
    case TrialPhase::kConfirmed:
      state_.refused.clear();
      state_.reason.clear();
      state_.shared.clear();
      let_in(version);
      report(JournalLevel::kNotice, "%s confirmed after %lld good cycles", version.c_str(),
             static_cast<long long>(state_.good_cycles));
      break;
    case TrialPhase::kTrying:
      report(JournalLevel::kNotice, "%s %s (%s): %s goes on with its trial",
             state_.previous.c_str(),
             step.cause != TrialCause::kNone ? "is no better"
             : state_.same > 0               ? "had it too, and it is over"
                                             : "did not have it, maybe by chance",
             state_.bad_cause.c_str(), version.c_str());
      if (step.cause == TrialCause::kNone) ++(state_.same > 0 ? state_.passed : state_.worse);
      restart_account(state_);
      state_.bad_cause = trial_cause_name(step.cause);
      share(state_, step.cause);
      state_.reason.clear();
      break;
    case TrialPhase::kComparing:
      state_.reason = with_last_error(step.reason);
      restart_account(state_);
      if (step.cause != TrialCause::kNone) state_.bad_cause = trial_cause_name(step.cause);
      break;
    case TrialPhase::kFailed:
      state_.reason = with_last_error(step.reason);
      break;
    case TrialPhase::kGoingBack:
      refuse_version(version, state_.phase == TrialPhase::kTrying ? with_last_error(step.reason)
                                                                  : step.reason);
      break;
    case TrialPhase::kRolledBack:  // dpkg did not end: what runs was never touched
      // Nor judged: it may come again, and dpkg may need it to mend its half work.
      state_.refused = std::exchange(state_.announced, "");
      state_.reason = step.reason;
      break;
    case TrialPhase::kUnknown:
    case TrialPhase::kUpgrading:
    case TrialPhase::kHidden:
      break;
  }
  state_.phase = step.phase;
  state_.is_handed_over = state_.is_handed_over && running_version(state_) == ran;
  if (!state_.reason.empty()) {
    report(JournalLevel::kError, "%s: %s",
           step.phase == TrialPhase::kRolledBack ? state_.refused.c_str() : version.c_str(),
           state_.reason.c_str());
  }
  return keep(trial_phase_name(step.phase).data(),
              step.phase == TrialPhase::kRolledBack ? state_.refused : version);
}

/// What the phase asks for and is not done yet.
void UpgradeTrial::act() {
  std::string error;
  if (state_.phase == TrialPhase::kGoingBack) {
    if (!state_.is_handed_over) start_other();
    if (!state_.is_handed_over) return;  // tried again
    state_.version = std::exchange(state_.previous, "");
    state_.phase = TrialPhase::kRolledBack;
    machine_.pin(state_.refused_all);
    if (!machine_.settle(state_, error)) report(JournalLevel::kError, "%s", error.c_str());
    const std::string refused = state_.refused;
    keep("rolled_back", refused);
    machine_.store().prune({state_.version});
    report(JournalLevel::kError, "%s is rolled back to %s: %s", refused.c_str(),
           state_.version.c_str(), state_.reason.c_str());
    return;
  }
  if (is_on_trial() && !state_.is_handed_over) {
    start_other();
    write();
  }
  if (state_.phase == TrialPhase::kRolledBack && !machine_.settle(state_, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
  }
  if (state_.phase == TrialPhase::kConfirmed) {
    if (!machine_.settle(state_, error)) report(JournalLevel::kError, "%s", error.c_str());
    machine_.store().prune({state_.version, state_.previous});
    machine_.store().reserve();
  }
}

void UpgradeTrial::watch(std::int64_t passed_s) {
  TrialUnit unit = machine_.unit();
  const TrialState before = state_;
  if (state_.restarts < 0 || unit.restarts < state_.restarts) state_.restarts = unit.restarts;
  const TrialLimits limits = machine_.limits();
  if (is_on_trial()) {
    const std::string program = machine_.store().program_of(running_version(state_));
    const bool must_write = wants_control(machine_.settings());
    const auto cycles = last_cycles(program, machine_.settings(), must_write);
    TrialUnit since = unit;
    since.restarts -= state_.restarts;
    count_restarts(state_, since);
    if (count_new_cycles(state_, cycles, limits)) state_.restarts = unit.restarts;
  }
  unit.restarts -= state_.restarts;
  const std::int64_t due_s = unkept_s_ + passed_s;
  count_time(state_, unit, due_s);
  unkept_s_ = unit.is_stopped && state_.phase != TrialPhase::kUpgrading ? 0 : due_s;
  const TrialStep step = next_phase(state_, unit, limits);
  const bool has_minute = state_.elapsed_s / 60 != before.elapsed_s / 60 ||
                          state_.rest_s / 60 != before.rest_s / 60;  // to spare the card
  const bool has_news = state_.mark != before.mark || state_.restarts != before.restarts;
  if (step.phase != state_.phase) {
    if (!take(step)) {
      state_ = before;  // as on the disk; the time that has passed counts on
      return;
    }
    act();
    unkept_s_ = 0;
  } else if ((has_news || has_minute) && write()) {
    unkept_s_ = 0;
  }
}

bool UpgradeTrial::is_over() const {
  return state_.phase == TrialPhase::kUnknown || state_.phase == TrialPhase::kConfirmed ||
         state_.phase == TrialPhase::kRolledBack || state_.phase == TrialPhase::kFailed ||
         state_.phase == TrialPhase::kHidden;
}

int UpgradeTrial::look() {
  lock();
  read();
  if (is_over()) return 0;
  act();
  if (is_over()) return 0;
  watch(machine_.limits().poll_s);
  return write() ? 0 : 1;
}

void UpgradeTrial::count_boot() {
  const std::string boot = TrialMachine::boot_id();
  if (!is_on_trial() || state_.boot == boot) return;
  if (!state_.boot.empty()) ++state_.boots;
  if (!state_.is_fresh) state_.elapsed_s = 0;  // nor is an order in force that could be kept
  state_.boot = boot;
  write();
}

/// Where dpkg ends its work after the trial: what it has is told anew. False once there is nothing
/// to wait for.
bool UpgradeTrial::awaits_dpkg(std::int64_t waited_s) {
  if (state_.phase == TrialPhase::kUnknown || state_.phase == TrialPhase::kHidden) return false;
  if (state_.delivered != TrialMachine::delivered() && !write()) return false;
  return !dpkg_mend(state_.delivered).empty() && waited_s < machine_.limits().upgrade_s;
}

int UpgradeTrial::supervise() {
  std::int64_t seen_s = uptime_s();
  std::int64_t waited_s = 0;
  while (true) {
    lock();
    read();
    if (is_over()) {
      if (!awaits_dpkg(waited_s)) return 0;
      unlock();
      waited_s += machine_.limits().poll_s;
      sleep(static_cast<unsigned>(machine_.limits().poll_s));
      continue;
    }
    count_boot();
    const std::int64_t passed_s = uptime_s() - seen_s;
    seen_s += passed_s;
    act();
    if (!is_over()) watch(passed_s);
    unlock();
    if (is_over()) continue;
    sleep(static_cast<unsigned>(machine_.limits().poll_s));
  }
}

/// At boot, before the controller: what was broken off is made whole, and what a card has damaged
/// is not run.
int UpgradeTrial::recover() {
  lock();
  read();
  if (state_.phase == TrialPhase::kUpgrading) {
    // The power went while dpkg was at it: no fault of that version. dpkg is asked to end it.
    state_.phase = phase_without_announcement(state_);
    const std::string announced = std::exchange(state_.announced, "");
    report(JournalLevel::kWarning, "the installation of %s was broken off", announced.c_str());
    keep("broken_off", announced);
  }
  const VersionStore& store = machine_.store();
  const std::string running = running_version(state_);
  const bool is_damaged = !running.empty() && !store.has_whole(running);
  if (is_damaged) {
    const bool has_other = running != state_.previous && store.has_whole(state_.previous);
    report(JournalLevel::kError, "%s is damaged%s%s", running.c_str(),
           has_other ? "; what runs instead: " : "", has_other ? state_.previous.c_str() : "");
    if (has_other) {
      refuse_version(running, "its files are damaged");
      state_.phase = TrialPhase::kGoingBack;
      keep("going_back", running);
    }
  }
  std::string error;
  if (!machine_.settle(state_, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  const bool waits = is_on_trial() || state_.phase == TrialPhase::kGoingBack;
  if (waits && !state_.is_handed_over) {
    mark_newest_cycle(store.program_of(running_version(state_)));
    state_.is_handed_over = true;  // nothing runs yet: what starts is what the link leads to
    write();
  }
  if (state_.phase == TrialPhase::kGoingBack) act();
  return 0;
}

}  // namespace bess
