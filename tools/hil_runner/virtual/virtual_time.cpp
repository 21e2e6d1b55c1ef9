#include "tools/hil_runner/virtual/virtual_time.h"

#include <signal.h>
#include <sys/timex.h>
#include <time.h>

#include <algorithm>
#include <cerrno>

#include "tools/hil_runner/base/stop_request.h"

namespace bess {
namespace {

VirtualTime* current_time = nullptr;

/// The edge starts one minute earlier, to read before the first tick.
constexpr std::int64_t kLeadNs = 60 * kNanosecondsPerSecond;

}  // namespace

VirtualTime::VirtualTime(const Scenario& scenario)
    : scenario_(scenario),
      start_utc_ns_(scenario.start_utc_s * kNanosecondsPerSecond - 2 * kLeadNs),
      now_ns_(kLeadNs),  // not 0, which often means "never"
      events_(scenario.events) {
  const ScenarioEvent end{.at_min = scenario.minutes, .kind = ScenarioEvent::EventKind::kEdgeStop};
  events_.push_back(end);
  std::ranges::stable_sort(events_, {}, &ScenarioEvent::at_min);
  current_time = this;
}

VirtualTime::~VirtualTime() { current_time = nullptr; }

VirtualTime* VirtualTime::current() { return current_time; }

std::int64_t VirtualTime::time_of(const ScenarioEvent& event) const {
  return scenario_.utc_ns_at(event.at_min) - start_utc_ns_;
}

bool VirtualTime::has_event_until(std::int64_t monotonic_ns) const {
  return has_event() && time_of(events_[next_event_]) <= monotonic_ns;
}

void VirtualTime::advance_to(std::int64_t monotonic_ns) {
  throw_if_stopped();
  while (has_event_until(monotonic_ns) || (edge_is_paused_ && has_event())) {
    const ScenarioEvent& event = events_[next_event_++];
    now_ns_ = std::max(now_ns_, time_of(event));
    apply(event);
    // A paused process receives its signals when it continues.
    if (signal_ != 0 && !edge_is_paused_) return;
  }
  if (!has_event()) edge_is_paused_ = false;  // no event is left to continue it
  now_ns_ = std::max(now_ns_, monotonic_ns);
}

void VirtualTime::apply(const ScenarioEvent& event) {
  using enum ScenarioEvent::EventKind;
  switch (event.kind) {
    case kEdgeKill:
      if (edge_runs_) throw EdgeKilled{};
      break;
    case kEdgeStop:
      if (signal_ == 0 && edge_runs_) signal_ = SIGTERM;
      break;
    case kEdgeHandOver:
      if (signal_ == 0 && edge_runs_) signal_ = SIGHUP;
      break;
    case kEdgeStart:
      edge_runs_ = true;
      break;
    case kEdgePause:
    case kEdgeContinue:
      edge_is_paused_ = event.kind == kEdgePause;
      break;
    case kBatteryPause:
    case kBatteryContinue:
      battery_is_paused_ = event.kind == kBatteryPause;
      break;
    case kMarketPause:
      market_ = Market::kPaused;
      break;
    case kMarketKill:
      market_ = Market::kDead;
      break;
    case kMarketContinue:
    case kMarketStart:
      market_ = Market::kServes;
      break;
    case kClockStep:
      step_ns_ += static_cast<std::int64_t>(event.seconds * 1e9);
      break;
    case kClockUnsynchronised:
    case kClockSynchronised:
      synchronised_ = event.kind == kClockSynchronised;
      break;
    case kHold:
    case kHoldRelease:
    case kLimit:
    case kLimitClear:
    case kLimitTorn:
    case kClear:
    case kStateLost:
      on_operator_(event);
      break;
    case kDiskFull:
      break;  // refused by the reader: no disk in virtual time
  }
}

int VirtualTime::take_signal() { return edge_is_paused_ ? 0 : std::exchange(signal_, 0); }

bool VirtualTime::advance_to_next_start() {
  edge_runs_ = false;
  signal_ = 0;
  const std::int64_t end_ns = scenario_.end_utc_ns() - start_utc_ns_;
  while (!edge_runs_ && has_event_until(end_ns)) advance_to(time_of(events_[next_event_]));
  if (!edge_runs_) now_ns_ = std::max(now_ns_, end_ns);
  return edge_runs_;
}

}  // namespace bess

// Replacements of C library functions, by the linker, in objects of this program only.
extern "C" {

int __real_clock_gettime(clockid_t id, timespec* time);
int __real_clock_nanosleep(clockid_t id, int flags, const timespec* until, timespec* left);
int __real_sigtimedwait(const sigset_t* set, siginfo_t* info, const timespec* timeout);
int __real_adjtimex(timex* state);

int __wrap_clock_gettime(clockid_t id, timespec* time) {
  const bess::VirtualTime* const now = bess::VirtualTime::current();
  if (now == nullptr) return __real_clock_gettime(id, time);
  const std::int64_t ns = id == CLOCK_REALTIME ? now->edge_utc_ns() : now->monotonic_ns();
  time->tv_sec = static_cast<time_t>(ns / bess::kNanosecondsPerSecond);
  time->tv_nsec = static_cast<long>(ns % bess::kNanosecondsPerSecond);
  return 0;
}

int __wrap_clock_nanosleep(clockid_t id, int flags, const timespec* until, timespec* left) {
  bess::VirtualTime* const now = bess::VirtualTime::current();
  if (now == nullptr) return __real_clock_nanosleep(id, flags, until, left);
  const std::int64_t ns =
      std::int64_t{until->tv_sec} * bess::kNanosecondsPerSecond + until->tv_nsec;
  now->advance_to((flags & TIMER_ABSTIME) != 0 ? ns : now->monotonic_ns() + ns);
  return 0;
}

int __wrap_sigtimedwait(const sigset_t* set, siginfo_t* info, const timespec* timeout) {
  bess::VirtualTime* const now = bess::VirtualTime::current();
  if (now == nullptr) return __real_sigtimedwait(set, info, timeout);
  int signal = now->take_signal();
  if (signal == 0) {
    const std::int64_t wait_ns =
        std::int64_t{timeout->tv_sec} * bess::kNanosecondsPerSecond + timeout->tv_nsec;
    if (wait_ns > 0) now->advance_to(now->monotonic_ns() + wait_ns);
    signal = now->take_signal();
  }
  if (signal != 0) return signal;
  errno = EAGAIN;
  return -1;
}

int __wrap_adjtimex(timex* state) {
  const bess::VirtualTime* const now = bess::VirtualTime::current();
  if (now == nullptr) return __real_adjtimex(state);
  state->status = now->is_synchronised() ? 0 : STA_UNSYNC;
  return now->is_synchronised() ? TIME_OK : TIME_ERROR;
}

}  // extern "C"
