// One upgrade on one machine, as `bess-edge trial` drives it. Where its methods are:
// trial_book.cpp what is kept and refused, trial_delivery.cpp what dpkg brings, trial_watch.cpp the
// supervision, trial_run.cpp what a person asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "edge/update/trial.h"
#include "edge/update/trial_machine.h"
#include "edge/update/trial_state.h"
#include "shared/file_descriptor.h"

namespace bess {

/// One upgrade on one machine: every verb is a method. The state is on the disk before anything is
/// done by it, so that what a power cut breaks off is done again from there.
class UpgradeTrial {
 public:
  UpgradeTrial();

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
  static std::string since_now();
  bool is_on_trial() const;
  bool is_over() const;
  bool awaits_dpkg(std::int64_t waited_s);

  TrialMachine machine_;
  std::string folder_;
  std::optional<FileDescriptor> lock_;
  TrialState state_;
  std::int64_t unkept_s_ = 0;  ///< time that passed since the state was written last
};

}  // namespace bess
