#include "edge/update/trial_run.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <optional>
#include <utility>
#include <vector>

#include "edge/log/journal.h"
#include "edge/update/trial_cycles.h"
#include "edge/update/trial_machine.h"
#include "edge/update/trial_state.h"
#include "edge/update/version_proof.h"
#include "edge/update/words.h"
#include "shared/file_descriptor.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::string test_root() {
  const char* const root = std::getenv("BESS_ROOT");
  return root == nullptr ? "" : root;
}

std::int64_t now_utc_s() { return time(nullptr); }

std::int64_t uptime_s() {
  timespec now{};
  clock_gettime(CLOCK_BOOTTIME, &now);
  return now.tv_sec;
}

/// One upgrade on one machine: every verb is a method. The state is on the disk before anything is
/// done by it, so that what a power cut breaks off is done again from there.
class Trial {
 public:
  Trial() : machine_(test_root()), folder_(machine_.path(kUpdateFolder)) {}

  int announce(const std::string& version);
  int withdraw(const std::string& version);
  int begin();
  int supervise();
  int look();
  int recover();
  int go_back(const std::string& reason);
  int dismiss();
  int allow(const std::string& version);

 private:
  int keep_out(const std::string& version, const std::string& why);
  int confirm_again(const std::string& version);
  void count_version_before(const std::string& running, const std::string& next);
  void let_in(const std::string& version);
  std::string with_last_error(std::string reason) const;
  void lock();
  void unlock() { lock_.reset(); }
  void read();
  bool keep(const char* event, const std::string& version);
  bool write();
  void watch(std::int64_t passed_s);
  bool take(const TrialStep& step);
  void act();
  void start_other();
  void refuse_version(const std::string& version, const std::string& reason);
  bool is_refused(const std::string& version) const;
  bool is_unended(const std::string& version) const;
  void mark_newest_cycle(const std::string& program);
  void count_boot();
  std::string since_now() const { return std::string(utc_text(now_utc_s()).view()); }
  bool is_over() const;
  bool awaits_dpkg(std::int64_t waited_s);

  TrialMachine machine_;
  std::string folder_;
  std::optional<FileDescriptor> lock_;
  TrialState state_;
  std::int64_t unkept_s_ = 0;  ///< time that passed since the state was written last
};

/// One writer at a time.
void Trial::lock() {
  mkdir(machine_.store().folder().c_str(), 0755);
  mkdir(folder_.c_str(), 0755);
  lock_.emplace(open((folder_ + "/lock").c_str(),  // NOLINT: mode_t is what open takes
                     O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (lock_->get() >= 0) flock(lock_->get(), LOCK_EX);
}

void Trial::read() {
  const ReadTrialState found = read_trial_state(folder_);
  state_ = found.state;
  if (found.damage.empty()) return;
  report(JournalLevel::kError, "%s", found.damage.c_str());
  if (state_.phase == TrialPhase::kFailed && state_.version.empty()) {
    // What runs stays, and what judged last is the way back.
    state_.version = machine_.store().pointed("current");
    const std::string confirmed = machine_.store().pointed("confirmed");
    if (confirmed != state_.version) state_.previous = confirmed;
  }
  write();
}

bool Trial::write() {
  state_.delivered = TrialMachine::delivered();
  std::string error;
  if (write_trial_state(folder_, state_, error)) return true;
  if (machine_.store().use_reserve() && write_trial_state(folder_, state_, error)) return true;
  report(JournalLevel::kError, "%s", error.c_str());
  return false;
}

bool Trial::keep(const char* event, const std::string& version) {
  if (!write()) return false;
  const std::string of = machine_.store().folder_of(version);
  add_to_history(folder_, {since_now(), event, version, certificate_fact(of, "student"),
                           certificate_fact(of, "header_sha256"), state_.reason});
  return true;
}

/// Told as refused, and may come again: dpkg was at fault.
bool Trial::is_unended(const std::string& version) const {
  return state_.refused == version && !version.empty() && !is_refused(version);
}

bool Trial::is_refused(const std::string& version) const {
  return (" " + state_.refused_all + " ").find(" " + version + " ") != std::string::npos;
}

void Trial::refuse_version(const std::string& version, const std::string& reason) {
  state_.refused = version;
  state_.reason = one_line(reason, 300);
  if (version.empty() || is_refused(version)) return;
  if (!state_.refused_all.empty()) state_.refused_all += ' ';
  state_.refused_all += version;
  constexpr std::size_t kKnownBytesMax = 350;  // of a state's line: the oldest are forgotten
  while (state_.refused_all.size() > kKnownBytesMax) {
    state_.refused_all.erase(0, state_.refused_all.find(' ') + 1);
  }
}

void Trial::let_in(const std::string& version) {
  std::string left;
  for (std::size_t at = 0; at < state_.refused_all.size();) {
    const std::size_t end = std::min(state_.refused_all.find(' ', at), state_.refused_all.size());
    const std::string one = state_.refused_all.substr(at, end - at);
    if (one != version) left.append(left.empty() ? "" : " ").append(one);
    at = end + 1;
  }
  state_.refused_all = left;
  machine_.pin(left);
}

/// The newest error of this trial's time; none of an older one.
std::string Trial::with_last_error(std::string reason) const {
  std::int64_t since_utc_s = 0;
  static_cast<void>(parse_utc(state_.since_utc, since_utc_s));
  const std::string told = TrialMachine::last_error(since_utc_s);
  if (!told.empty()) reason.append(": ").append(told);
  return one_line(reason, 300);
}

/// Before dpkg unpacks anything.
int Trial::announce(const std::string& version) {
  lock();
  read();
  if (is_refused(version)) {
    report(JournalLevel::kError, "%s was rolled back here%s%s; bess-edge trial allow %s lets it in",
           version.c_str(), state_.refused == version ? ": " : "",
           state_.refused == version ? state_.reason.c_str() : "", version.c_str());
    return 1;
  }
  state_.announced = version;
  const bool is_on_trial = state_.phase == TrialPhase::kTrying ||
                           state_.phase == TrialPhase::kComparing ||
                           state_.phase == TrialPhase::kGoingBack;
  if (!is_on_trial) {
    if (state_.version.empty()) state_.version = machine_.store().pointed("current");
    state_.phase = TrialPhase::kUpgrading;
    state_.since_utc = since_now();
    state_.elapsed_s = 0;
  }
  return write() ? 0 : 1;
}

/// dpkg could not bring what it announced, and has what it had: no fault of that version, which may
/// come again.
int Trial::withdraw(const std::string& version) {
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
int Trial::begin() {
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
int Trial::keep_out(const std::string& version, const std::string& why) {
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
int Trial::confirm_again(const std::string& version) {
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
void Trial::count_version_before(const std::string& running, const std::string& next) {
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

void Trial::mark_newest_cycle(const std::string& program) {
  for (const SeenCycle& seen : last_cycles(program, machine_.settings(), false)) {
    state_.mark = seen.name;
  }
}

/// Another version than before runs from here on: flip, stop, start. The version that has confirmed
/// itself is not stopped but hands its order over, and what runs already stays: a hand-over that
/// was broken off behind the flip. Nor is anything stopped for a link that cannot be flipped: tried
/// again.
void Trial::start_other() {
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
bool Trial::take(const TrialStep& step) {
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
void Trial::act() {
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
  const bool is_run = state_.phase == TrialPhase::kTrying || state_.phase == TrialPhase::kComparing;
  if (is_run && !state_.is_handed_over) {
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

void Trial::watch(std::int64_t passed_s) {
  TrialUnit unit = machine_.unit();
  const TrialState before = state_;
  if (state_.restarts < 0 || unit.restarts < state_.restarts) state_.restarts = unit.restarts;
  const TrialLimits limits = machine_.limits();
  const bool is_run = state_.phase == TrialPhase::kTrying || state_.phase == TrialPhase::kComparing;
  if (is_run) {
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

bool Trial::is_over() const {
  return state_.phase == TrialPhase::kUnknown || state_.phase == TrialPhase::kConfirmed ||
         state_.phase == TrialPhase::kRolledBack || state_.phase == TrialPhase::kFailed ||
         state_.phase == TrialPhase::kHidden;
}

int Trial::look() {
  lock();
  read();
  if (is_over()) return 0;
  act();
  if (is_over()) return 0;
  watch(machine_.limits().poll_s);
  return write() ? 0 : 1;
}

void Trial::count_boot() {
  const std::string boot = TrialMachine::boot_id();
  const bool is_run = state_.phase == TrialPhase::kTrying || state_.phase == TrialPhase::kComparing;
  if (!is_run || state_.boot == boot) return;
  if (!state_.boot.empty()) ++state_.boots;
  if (!state_.is_fresh) state_.elapsed_s = 0;  // nor is an order in force that could be kept
  state_.boot = boot;
  write();
}

/// Where dpkg ends its work after the trial: what it has is told anew. False once there is nothing
/// to wait for.
bool Trial::awaits_dpkg(std::int64_t waited_s) {
  if (state_.phase == TrialPhase::kUnknown || state_.phase == TrialPhase::kHidden) return false;
  if (state_.delivered != TrialMachine::delivered() && !write()) return false;
  return !dpkg_mend(state_.delivered).empty() && waited_s < machine_.limits().upgrade_s;
}

int Trial::supervise() {
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
int Trial::recover() {
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
  const bool waits = state_.phase == TrialPhase::kTrying ||
                     state_.phase == TrialPhase::kComparing ||
                     state_.phase == TrialPhase::kGoingBack;
  if (waits && !state_.is_handed_over) {
    mark_newest_cycle(store.program_of(running_version(state_)));
    state_.is_handed_over = true;  // nothing runs yet: what starts is what the link leads to
    write();
  }
  if (state_.phase == TrialPhase::kGoingBack) act();
  return 0;
}

int Trial::go_back(const std::string& reason) {
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

int Trial::dismiss() {
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

int Trial::allow(const std::string& version) {
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

}  // namespace

int run_trial_verb(const std::string& verb, const std::string& argument) {
  struct Plain {
    const char* name;
    int (Trial::*run)();
  };
  struct Argued {
    const char* name;
    int (Trial::*run)(const std::string&);
    const char* needs;
  };
  constexpr Plain kPlain[] = {{"begin", &Trial::begin},
                              {"supervise", &Trial::supervise},
                              {"look", &Trial::look},
                              {"recover", &Trial::recover},
                              {"dismiss", &Trial::dismiss}};
  constexpr Argued kArgued[] = {{"announce", &Trial::announce, "a version"},
                                {"withdraw", &Trial::withdraw, "a version"},
                                {"allow", &Trial::allow, "a version"},
                                {"go-back", &Trial::go_back, "a reason, which the history keeps"}};
  Trial trial;
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
