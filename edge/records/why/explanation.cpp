#include "edge/records/why/explanation.h"

#include "edge/core/control/policy.h"
#include "shared/local_time.h"

namespace bess {
namespace {

/// The same reason without interruption; one missing control cycle is allowed.
bool continues(const CycleRecord& before, const CycleRecord& after) {
  return before.reason == after.reason && before.utc_s < after.utc_s &&
         after.utc_s - before.utc_s <= 2 * kSecondsPerStep;
}

void find_beginning(const LogReader& log, std::uint64_t number, Explanation& explanation) {
  CycleRecord after = explanation.record;
  CycleRecord before;
  explanation.since_utc_s = after.utc_s;
  for (std::uint64_t n = number; n > log.oldest_number(); --n) {
    if (!log.read(n - 1, before)) continue;
    if (!continues(before, after)) return;
    explanation.since_utc_s = before.utc_s;
    ++explanation.cycles;
    after = before;
  }
}

/// The last control cycles with a reading, up to the one that tripped.
void find_evidence(const LogReader& log, Explanation& explanation) {
  constexpr std::uint64_t kCycles = 4;
  const std::uint64_t last = number_at(log, explanation.record.trip.utc_s);
  CycleRecord record;
  for (std::uint64_t n = last > kCycles ? last - kCycles + 1 : 1; n <= last; ++n) {
    if (log.read(n, record) && record.has_measurement) explanation.evidence.push_back(record);
  }
}

/// Input of the student.
LatticeState state_of(const CycleRecord& record) {
  return make_lattice_state(local_minute_of(record.utc_s), record.context_class,
                            record.measurement.soc_e4, decided_price_centi(record));
}

}  // namespace

bool explain(const LogReader& log, std::uint64_t number, const PriceThresholds& thresholds,
             Explanation& explanation) {
  explanation = {};
  if (!log.read(number, explanation.record)) return false;
  find_beginning(log, number, explanation);
  const CycleRecord& record = explanation.record;
  explanation.has_margins = margins_of(record, thresholds, explanation.margins);
  explanation.is_other_student =
      explanation.has_margins && decide_with_student(state_of(record)) != record.student_action;
  if (record.is_tripped) find_evidence(log, explanation);
  return true;
}

bool margins_of(const CycleRecord& record, const PriceThresholds& thresholds, Margins& margins) {
  if (!record.has_student_action || record.context_class == 0) return false;
  margins =
      find_margins(state_of(record), decided_price_centi(record), thresholds, decide_with_student);
  return true;
}

std::uint64_t number_at(const LogReader& log, std::int64_t utc_s) {
  CycleRecord record;
  for (std::uint64_t n = log.newest_number(); n >= log.oldest_number() && n > 0; --n) {
    if (!log.read(n, record)) continue;
    if (record.utc_s <= utc_s && utc_s < record.utc_s + kSecondsPerStep) return n;
  }
  return 0;
}

}  // namespace bess
