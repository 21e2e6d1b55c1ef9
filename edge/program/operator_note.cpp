#include "edge/program/operator_note.h"

#include <cstdio>

#include "edge/control/policy.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

template <typename... Values>
void add_line(std::string& note, const char* format, Values... values) {
  char line[160];
  std::snprintf(line, sizeof line, format, values...);
  note.append(line).append("\n");
}

}  // namespace

std::string operator_note(const ControlSettings& control, const Hold& hold,
                          std::int64_t now_utc_s) {
  std::string note;
  const HoldReport held = hold_at(hold, now_utc_s);
  if (held.held) {
    add_line(note, "hold       %d W until %s", held.power_w, utc_text(held.until_utc_s).c_str());
  }
  if (held.unreadable) add_line(note, "hold       %s", "its file is not readable: not followed");
  if (!control.reserve.empty()) {
    const std::int16_t now_e4 = reserve_soc_e4_at(control.reserve, local_minute_of(now_utc_s));
    add_line(note, "reserve    SoC %.1f %% at this hour, %d periods in all", now_e4 / 100.0,
             control.reserve.size());
  }
  for (int r = 0; r < guard_rule_count(); ++r) {
    add_line(note, "rule       %s", guard_rule_name(r));
  }
  if (control.full_charge_every_days > 0) {
    add_line(note, "full       every %d days, with %d W", control.full_charge_every_days,
             control.guard.full_charge_power_w);
  }
  return note;
}

}  // namespace bess
