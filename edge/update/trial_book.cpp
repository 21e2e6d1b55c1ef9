#include "edge/update/upgrade_trial.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <time.h>

#include <algorithm>
#include <cstdlib>

#include "edge/log/journal.h"
#include "edge/update/version_proof.h"
#include "shared/host/text.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

std::string test_root() {
  const char* const root = std::getenv("BESS_ROOT");
  return root == nullptr ? "" : root;
}

}  // namespace

UpgradeTrial::UpgradeTrial() : machine_(test_root()), folder_(machine_.path(kUpdateFolder)) {}

std::string UpgradeTrial::since_now() { return std::string(utc_text(time(nullptr)).view()); }

/// One writer at a time.
void UpgradeTrial::lock() {
  mkdir(machine_.store().folder().c_str(), 0755);
  mkdir(folder_.c_str(), 0755);
  lock_.emplace(open((folder_ + "/lock").c_str(),  // NOLINT: mode_t is what open takes
                     O_RDWR | O_CREAT | O_CLOEXEC, 0644));
  if (lock_->get() >= 0) flock(lock_->get(), LOCK_EX);
}

void UpgradeTrial::read() {
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

bool UpgradeTrial::write() {
  state_.delivered = TrialMachine::delivered();
  std::string error;
  if (write_trial_state(folder_, state_, error)) return true;
  if (machine_.store().use_reserve() && write_trial_state(folder_, state_, error)) return true;
  report(JournalLevel::kError, "%s", error.c_str());
  return false;
}

bool UpgradeTrial::keep(const char* event, const std::string& version) {
  if (!write()) return false;
  const std::string of = machine_.store().folder_of(version);
  add_to_history(folder_, {since_now(), event, version, certificate_fact(of, "student"),
                           certificate_fact(of, "header_sha256"), state_.reason});
  return true;
}

/// Told as refused, and may come again: dpkg was at fault.
bool UpgradeTrial::is_unended(const std::string& version) const {
  return state_.refused == version && !version.empty() && !is_refused(version);
}

bool UpgradeTrial::is_refused(const std::string& version) const {
  return (" " + state_.refused_all + " ").find(" " + version + " ") != std::string::npos;
}

void UpgradeTrial::refuse_version(const std::string& version, const std::string& reason) {
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

void UpgradeTrial::let_in(const std::string& version) {
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
std::string UpgradeTrial::with_last_error(std::string reason) const {
  std::int64_t since_utc_s = 0;
  static_cast<void>(parse_utc(state_.since_utc, since_utc_s));
  const std::string told = TrialMachine::last_error(since_utc_s);
  if (!told.empty()) reason.append(": ").append(told);
  return one_line(reason, 300);
}

}  // namespace bess
