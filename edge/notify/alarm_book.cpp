#include "edge/notify/alarm_book.h"

#include <algorithm>

namespace bess {

Alarm& AlarmBook::alarm_of(const Trouble& trouble, std::int64_t now_utc_s) {
  const auto found = std::find_if(alarms_.begin(), alarms_.end(),
                                  [&](const Alarm& alarm) { return alarm.key == trouble.key; });
  if (found != alarms_.end()) return *found;
  return alarms_.emplace_back(Alarm{.key = trouble.key, .since_utc_s = now_utc_s});
}

std::vector<AlarmEvent> AlarmBook::observe(const std::vector<Trouble>& troubles,
                                           std::int64_t now_utc_s) {
  std::vector<AlarmEvent> events;
  for (Alarm& alarm : alarms_) {  // a clock that was in the future must not silence anything
    alarm.since_utc_s = std::min(alarm.since_utc_s, now_utc_s);
    alarm.seen_utc_s = std::min(alarm.seen_utc_s, now_utc_s);
  }
  for (const Trouble& trouble : troubles) {
    Alarm& alarm = alarm_of(trouble, now_utc_s);
    alarm.text = trouble.text;
    alarm.seen_utc_s = now_utc_s;
    if (alarm.is_told || now_utc_s - alarm.since_utc_s < after_s_) continue;
    alarm.is_told = true;
    events.push_back({.is_over = false, .alarm = alarm});
  }
  std::erase_if(alarms_, [&](const Alarm& alarm) {
    // Strictly longer than 0, or with after_s = 0 what was just seen would be over.
    const std::int64_t away_s = now_utc_s - alarm.seen_utc_s;
    if (away_s == 0 || away_s < after_s_) return false;
    if (alarm.is_told) events.push_back({.is_over = true, .alarm = alarm});
    return true;
  });
  return events;
}

}  // namespace bess
