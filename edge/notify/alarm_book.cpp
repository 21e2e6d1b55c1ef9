#include "edge/notify/alarm_book.h"

#include <algorithm>

namespace bess {

std::vector<AlarmEvent> observe(std::vector<Alarm>& alarms, const std::vector<Trouble>& troubles,
                                std::int64_t after_s, std::int64_t now_utc_s) {
  std::vector<AlarmEvent> events;
  for (Alarm& alarm : alarms) {  // a clock that was in the future must not silence anything
    alarm.since_utc_s = std::min(alarm.since_utc_s, now_utc_s);
    alarm.seen_utc_s = std::min(alarm.seen_utc_s, now_utc_s);
  }
  for (const Trouble& trouble : troubles) {
    auto alarm = std::ranges::find(alarms, trouble.key, &Alarm::key);
    if (alarm == alarms.end()) {
      alarm = alarms.insert(alarm, {.key = trouble.key, .since_utc_s = now_utc_s});
    }
    alarm->text = trouble.text;
    alarm->seen_utc_s = now_utc_s;
    if (alarm->is_told || now_utc_s - alarm->since_utc_s < after_s) continue;
    alarm->is_told = true;
    events.push_back({.is_over = false, .alarm = *alarm});
  }
  std::erase_if(alarms, [&](const Alarm& alarm) {
    // Strictly longer than 0, or with after_s = 0 what was just seen would be over.
    const std::int64_t away_s = now_utc_s - alarm.seen_utc_s;
    if (away_s == 0 || away_s < after_s) return false;
    if (alarm.is_told) events.push_back({.is_over = true, .alarm = alarm});
    return true;
  });
  return events;
}

}  // namespace bess
