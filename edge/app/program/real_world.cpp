#include "edge/app/program/real_world.h"

#include "edge/app/program/find_battery.h"
#include "edge/app/program/startup.h"
#include "edge/app/storage/commission_file.h"
#include "edge/app/storage/operator_files.h"
#include "edge/app/storage/published_status.h"
#include "edge/core/control/policy.h"

namespace bess {
namespace {

constexpr std::int64_t kPlanningSMax = 30;  ///< first plans, on the slowest board
constexpr std::int64_t kMillisecondsNs = 1'000'000;

void write_farewell(const CycleRecord& last, bool is_in_control, bool ends_by_itself) {
  if (!is_in_control) {
    write_journal_line(JournalLevel::kNotice, "stopped: read-only, nothing written");
  } else if (last.reason == Reason::kHandOver) {
    write_journal_line(JournalLevel::kNotice, "stopped: handed over, the order stays in force");
  } else if (last.battery_status != Status::kOk && !ends_by_itself) {
    write_journal_line(JournalLevel::kError,
                       "stopped: release failed, and this battery has no dead-man timer: it may "
                       "follow its last order without end; start again, or reset it by hand");
  } else if (last.battery_status != Status::kOk) {
    write_journal_line(JournalLevel::kWarning,
                       "stopped: release failed, the battery's dead-man timer ends the order");
  } else {
    write_journal_line(JournalLevel::kNotice,
                       last.written ? "stopped: battery released" : "stopped: no order in force");
  }
}

}  // namespace

RealWorld::RealWorld(const EdgeConfig& config, const Devices& devices)
    : config_(config), devices_(devices), limits_{config.site.limit_file.c_str()} {}

bool RealWorld::record_battery(const std::string& path, FileMessage& error) {
  if (path.empty()) return true;
  if (!recorder_.start(path.c_str(),
                       recording_head_of(config_.battery.map, config_.battery.link, config_.clock),
                       config_.battery.map, config_.clock, error)) {
    return false;
  }
  battery().link().set_exchange_listener(recorder_.listener());
  return true;
}

bool RealWorld::open() {
  std::string refusal;
  if (config_.control.control && !is_commissioned(config_, refusal)) {
    complain(JournalLevel::kError, refusal);
    return false;
  }
  if (config_.control.control) {
    for (const std::string& line : repair_commission_file(config_)) {
      complain(JournalLevel::kError, line);
    }
  }
  published_ = published_log_number(config_);
  FileMessage error;
  if (log_.open(config_.log, identity_of_run(config_), error)) return true;
  complain(JournalLevel::kError, error.c_str());
  return false;
}

RestoredState RealWorld::restore_state() {
  const StateFilePaths paths = state_file_paths(config_, kClearedFileName);
  for (const FixedText<639>* path : {&paths.state, &paths.run}) {
    if (!read_cleared(path->c_str()).unreadable) continue;
    report(JournalLevel::kError, "%s is malformed: trips cleared there are active again",
           path->c_str());
  }
  RestoredState restored = bess::restore_state(log_.ring(), log_.run_ring(), published_, paths);
  if (restored.unknown.empty()) return restored;
  const char* const what = restored.unknown.c_str();
  if (restored.trip) {
    report(JournalLevel::kError,
           "state: %s: full-cycle budget and price level of earlier runs are unknown", what);
    return restored;
  }
  report(JournalLevel::kError,
         "state: %s: a trip may be lost, so there is no control until bess-edge clear --yes", what);
  restored.trip = trip_without_state(restored, utc_seconds(config_.clock));
  return restored;
}

const LatestHold& RealWorld::listen() {
  hold_watch_.start(state_file_paths(config_, kHoldFileName),
                    state_file_paths(config_, kClearedFileName), config_.clock.scale);
  return hold_watch_.latest_hold();
}

/// In wall time: bess-prices may just have started.
Status RealWorld::check_price_server() {
  const std::int64_t request_ms = config_.price.feed.http.timeout_ms + 1'000;
  return devices_.prices.first_answer(request_ms * kMillisecondsNs);
}

PublishedHistory RealWorld::find_history() {
  const std::int64_t wait_ns = config_.clock.wall_ns(kHistoryWait_s * kNanosecondsPerSecond);
  return devices_.prices.await_history(wait_ns + kNanosecondsPerSecond);
}

OutlookExchange* RealWorld::await_outlook(std::int32_t) {
  if (student_outlook() == nullptr) return nullptr;
  const std::int64_t patience_s = config_.outlook.http.timeout_ms / 1'000 + kPlanningSMax;
  needs_time(patience_s);
  return devices_.prices.await_outlook(patience_s * kNanosecondsPerSecond);
}

void RealWorld::complain(JournalLevel level, const std::string& line) {
  report(level, "%s", line.c_str());
}

void RealWorld::begins() {
  const bool is_in_control = config_.control.control;
  write_journal_line(JournalLevel::kNotice,
                     is_in_control ? "started: in control" : "started: read-only");
  const SettingsNote thresholds =
      compare_thresholds(config_.control.guard.thresholds, student_thresholds());
  if (!thresholds.is_warning) write_line(JournalLevel::kInfo, "guard: " + thresholds.text);
  for (const SettingsNote& note : {thresholds, transport_note(config_.price)}) {
    if (note.is_warning) complain(JournalLevel::kWarning, "note: " + note.text);
  }
  if (is_in_control) release_if_a_check_fails(battery());
}

void RealWorld::has_stopped(const CycleRecord& last, bool is_in_control, bool ends_by_itself) {
  constexpr std::int64_t kDrainNsMax = 5 * kNanosecondsPerSecond;
  if (!log_.drain(kDrainNsMax)) {
    report(JournalLevel::kWarning, "disk too slow: the last records are not logged");
  }
  write_farewell(last, is_in_control, ends_by_itself);
}

}  // namespace bess
