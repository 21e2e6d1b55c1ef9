#include "tools/hil_runner/wall/real_visit.h"

#include <fmt/core.h>
#include <signal.h>
#include <unistd.h>

#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"

namespace bess {

void RealVisit::heed_stop() const {
  if (key_.is_pressed()) request_stop();
  throw_if_stopped();
}

void RealVisit::commission() {
  constexpr useconds_t kLookUs = 50'000;
  edge_.start_command({"commission", "--yes"});
  while (edge_.runs()) {
    heed_stop();
    usleep(kLookUs);
  }
  if (edge_.wait() != 0) fail("{}", edge_.last_line());
}

void RealVisit::look() {
  heed_stop();
  const std::int64_t now_ns = clock_ns(CLOCK_MONOTONIC);
  CycleRecord cycle;
  if (now_ns < next_look_ns_) return;
  next_look_ns_ = now_ns + kNanosecondsPerSecond;
  if (!edge_.newest(cycle)) return;
  show(cycle);
  const std::string broken = beyond_limits(cycle, battery_);
  if (!broken.empty()) fail("stopped: {}, beyond the limits of --real", broken);
}

void RealVisit::show(const CycleRecord& cycle) const {
  if (isatty(STDERR_FILENO) == 0) return;
  fmt::print(stderr,
             "\r{}: minute {} of {:.0f}, {} W ordered, {} W measured, SoC {:.1f} %; Q ends it  ",
             scenario_.name, (cycle.utc_s - scenario_.start_utc_s) / 60, scenario_.minutes,
             cycle.ordered_power_w, cycle.measurement.power_w, cycle.measurement.soc_e4 / 100.0);
}

std::string RealVisit::next_recording() {
  recordings_.push_back(folder_.file(fmt::format("bus-{}.jsonl", recordings_.size() + 1)));
  return recordings_.back();
}

void RealVisit::give_back() {
  edge_.end(SIGTERM);
  CycleRecord last;
  if (edge_.newest(last) && last.mode == Mode::kStopping && last.battery_status == Status::kOk) {
    return fmt::print(stderr, "{}: mode=stopping battery=ok\n", scenario_.name);
  }
  edge_.start_command({"release", "--yes"});
  const int code = edge_.wait();
  fmt::print(stderr, "{}: {}\n", scenario_.name, edge_.last_line());
  if (code != 0) fmt::print(stderr, "{}: NOT RELEASED, look after the battery\n", scenario_.name);
}

void RealVisit::tell(Evidence& evidence) const {
  evidence.orders =
      orders_on_the_bus(recordings_, edge_.config().battery.map, scenario_.end_utc_ns());
  evidence.minutes = measured_minutes(evidence.log);
}

}  // namespace bess
