#include "edge/program/startup.h"

#include <signal.h>
#include <sys/prctl.h>

#include "edge/control/decision_signature.h"
#include "edge/control/policy.h"
#include "edge/log/journal.h"
#include "edge/program/start_notes.h"
#include "edge/settings/price_config.h"
#include "edge/storage/commission_file.h"
#include "shared/local_time.h"

namespace bess {
bool check_student() {
  set_market_time_zone();  // a plan of local days is one of the checks
  const int failures = count_student_self_check_failures();
  if (failures == 0) return true;
  report(JournalLevel::kError,
         "the built-in student fails %d of its %d self-checks on this machine; build bess-edge for "
         "it again",
         failures, student_self_check_count());
  return false;
}

bool reach_battery(const EdgeConfig& config, ModbusBattery& battery, EdgeClock& clock) {
  const BatterySearch found = find_battery(config, battery, clock);
  if (found.status == Status::kOk) return true;
  report(JournalLevel::kError, "battery at %s", found.trouble.c_str());
  return false;
}

void report_commission_losses(const EdgeConfig& config) {
  for (const std::string& line : mend_commission_file(config)) {
    report(JournalLevel::kError, "%s", line.c_str());
  }
}

Recall recall_at_start(const EdgeConfig& config, const EventLog& log,
                       std::uint64_t published_number) {
  const BothPlaces paths = both_places(config, kClearedFileName);
  for (const FixedText<639>* path : {&paths.state, &paths.run}) {
    if (!read_cleared(path->c_str()).unreadable) continue;
    report(JournalLevel::kError,
           "%s cannot be understood: a trip that was cleared there counts again", path->c_str());
  }
  Recall recalled = recall(log.ring(), log.run_ring(), published_number, paths);
  if (recalled.unknown.empty()) return recalled;
  const char* const what = recalled.unknown.c_str();
  if (recalled.trip.is_set()) {
    report(JournalLevel::kError,
           "state: %s: cycle budget and price level of earlier runs are not known", what);
    return recalled;
  }
  report(JournalLevel::kError,
         "state: %s: the battery may have tripped and is not driven until bess-edge clear --yes",
         what);
  recalled.trip = trip_without_state(recalled, config.clock.now_utc_ns() / kNanosecondsPerSecond);
  return recalled;
}

void journal_thresholds(const EdgeConfig& config) {
  const ThresholdNote note =
      compare_thresholds(config.control.guard.thresholds, student_thresholds());
  if (!note.agree) return report(JournalLevel::kWarning, "note: %s", note.text.c_str());
  write_journal_line(JournalLevel::kInfo, "guard: " + note.text);
}

void journal_transport(const EdgeConfig& config) {
  const TransportNote note = transport_note({config.price.feed, config.price.history});
  if (note.is_open) report(JournalLevel::kWarning, "note: %s", note.text.c_str());
}

std::string decision_signature_line() {
  set_market_time_zone();
  return signature_line(student_hash(), replay_recorded_days()).c_str();
}

void prepare_process() {
  set_market_time_zone();
  signal(SIGPIPE, SIG_IGN);           // whoever reads the log may go away, the battery must not
  prctl(PR_SET_TIMERSLACK, 1'000UL);  // ns; the default 50 us would be seen at high time scales
}

}  // namespace bess
