// The judge of an upgrade: what the cycles of a version on trial say of it. Pure: what is seen
// comes in, a phase comes out; trial_run.cpp sees and acts.
//
//   confirmed --announce--> upgrading --begin--> trying --enough good cycles--> confirmed
//                               |                 |  ^
//           dpkg does not end   |     it fails in |  | the version before fails in the same way:
//           or a proof fails    |     some way    v  | the site is to blame, the trial goes on
//                               |               comparing (the version before runs)
//                               v                 | the version before does better
//                           rolled_back <--- going_back <--- too late, a trip, no way to tell
//
// Good cycles follow each other: so many of the last so many. A cycle that is lost for a cause that
// the version before had as well counts for nothing, until the first cycle without that cause.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace bess {

enum class TrialPhase : std::uint8_t {
  kUnknown,    ///< no package was ever on trial here
  kUpgrading,  ///< dpkg is at it; what runs is untouched
  kTrying,     ///< the new version runs and is counted
  kComparing,  ///< the version before runs: does it fare better at this site, now?
  kConfirmed,
  kGoingBack,   ///< decided, not yet done
  kRolledBack,  ///< the version before runs; the new one is refused
  kFailed,      ///< did not confirm, and there is none before it
  kHidden,      ///< this user may not read it
};
std::string_view trial_phase_name(TrialPhase phase);
TrialPhase trial_phase_of(std::string_view name);  ///< kUnknown for anything else

/// Why a cycle was no good one, as far as a site can be to blame for it.
enum class TrialCause : std::uint8_t {
  kNone,  ///< nothing of the site: the version's own
  kNoStart,
  kNoCycle,  ///< it runs, and nothing comes of it
  kTrip,
  kPrice,
  kLink,
  kAlarm,  ///< the battery's own: an alarm, its temperature
  kOffGrid,
  kClock,
  kHold,
};
inline constexpr int kTrialCauseCount = static_cast<int>(TrialCause::kHold) + 1;
std::string_view trial_cause_name(TrialCause cause);
TrialCause trial_cause_of(std::string_view name);  ///< kNone for anything else

/// One cycle, as the program that ran it tells.
struct TrialCycle {
  bool is_good = false;
  TrialCause cause = TrialCause::kNone;
  std::int64_t missed_ticks = 0;  ///< before it, since the cycle before
};

/// Of /etc/bess/update.conf, and what is fixed.
struct TrialLimits {
  std::int64_t good_cycles = 15;
  std::int64_t deadline_s = 3'600;  ///< of running time for the good cycles, and for a rest
  std::int64_t poll_s = 10;
  /// From the hand-over to the first cycle: a tick that was missed, the next one and its price, 146
  /// s. At a battery whose timer has 300 s the order from before has 180 s left then at least.
  std::int64_t first_cycle_s = 160;
  std::int64_t upgrade_s = 600;  ///< for dpkg between unpacking and configuring
  std::int64_t restarts = 5;     ///< without a good cycle in between
  std::int64_t boots = 5;

  /// 15 of the last 18.
  [[nodiscard]] std::int64_t window() const { return good_cycles + good_cycles / 5; }
};
inline constexpr std::int64_t kStandingCycles = 5;  ///< so many in a row: not a passing trouble
inline constexpr std::int64_t kPassedMax = 3;  ///< so often a trouble may end while one compares
/// A trouble of the site may end by chance just when the version before starts; not twice.
inline constexpr std::int64_t kWorseMax = 2;
inline constexpr std::int64_t kSameCycles = 3;  ///< of the version before, with that trouble too

/// All that is kept of an upgrade (trial_state.h), each change of it on the disk before it is acted
/// on.
struct TrialState {
  TrialPhase phase = TrialPhase::kUnknown;
  std::string version;      ///< on trial, or the one that runs; empty = none
  std::string previous;     ///< the way back; empty = none
  std::string announced;    ///< that dpkg is about to bring; empty = none
  std::string refused;      ///< the last one that was rolled back; empty = none
  std::string refused_all;  ///< every one that is not let in again, separated by spaces
  std::string reason;
  std::string since_utc;
  std::string boot;       ///< id of the boot that was counted last
  std::string delivered;  ///< dpkg's view of the package: "ii 2.0"
  std::string mark;       ///< the newest cycle that was counted: "UTC CYCLE"
  std::string window;     ///< the last cycles, '1' good, '0' not; the newest last
  std::string shared;     ///< causes that the version before has as well, separated by commas
  std::string bad_cause;  ///< of the cycles of bad_run
  std::int64_t good_cycles = 0;    ///< in the window
  std::int64_t needed_cycles = 0;  ///< for a confirmation
  std::int64_t elapsed_s = 0;      ///< of this phase, while it does not rest
  std::int64_t rest_s = 0;         ///< since the rest began
  std::int64_t bad_run = 0;
  std::int64_t same = 0;  ///< cycles of the version before with bad_cause, while comparing
  std::int64_t other = 0;
  std::int64_t passed = 0;  ///< comparisons in which the trouble ended by itself
  std::int64_t worse = 0;   ///< comparisons in which the version before did not have it at all
  std::int64_t boots = 0;
  std::int64_t restarts =
      -1;                 ///< that systemd had counted at the last good cycle; -1 = not seen yet
  bool is_fresh = false;  ///< a cycle of the process that is judged was seen
  bool is_handed_over = false;  ///< from the version before to this one
};

/// The unit, as systemd sees it.
struct TrialUnit {
  bool is_stopped = false;    ///< by a person: everything rests
  bool has_failed = false;    ///< systemd has given up
  std::int64_t restarts = 0;  ///< since the last good cycle, or since what is judged was started
};

/// What the version before needs to be equalled: `before` are its last cycles, oldest first.
std::int64_t needed_good_cycles(const std::vector<TrialCycle>& before, const TrialLimits& limits);

bool is_shared(const TrialState& state, TrialCause cause);
void share(TrialState& state, TrialCause cause);

/// Takes one cycle of the version that runs into the account of a trial or of a comparison.
void count_cycle(TrialState& state, const TrialCycle& cycle, const TrialLimits& limits);

/// Takes into a comparison that the version before does not start either.
void count_restarts(TrialState& state, const TrialUnit& unit);

/// Takes the time that has passed into it.
void count_time(TrialState& state, const TrialUnit& unit, std::int64_t passed_s);

struct TrialStep {
  TrialPhase phase;
  std::string reason;  ///< where it changes for the worse
  TrialCause cause = TrialCause::kNone;
};

/// The phase that follows from what was counted; the same one where nothing does.
TrialStep next_phase(const TrialState& state, const TrialUnit& unit, const TrialLimits& limits);

/// What is begun anew whenever another version is started.
void restart_account(TrialState& state);

/// Where dpkg has taken its announcement back: the phase before it.
TrialPhase phase_without_announcement(const TrialState& state);

/// The version that must run in this state, and the one that judges; empty = leave it as it is.
std::string running_version(const TrialState& state);
std::string judging_version(const TrialState& state);

}  // namespace bess
