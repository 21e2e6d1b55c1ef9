#include "edge/log/journal_lines.h"

#include <utility>

#include "shared/utc_text.h"

namespace bess {

bool HoldLines::add_line(const CycleRecord& record, bool is_in_control, TextBuffer& line) {
  if (record.mode == Mode::kStopping) return false;  // it asks for no hold; the next run goes on
  const HoldReport now = record.hold;
  const HoldReport before = std::exchange(before_, now);
  if (now.unreadable) {
    if (before.unreadable) return false;
    line.add(
        "hold: the file hold in [state] folder is not one that bess-edge hold wrote, or ends "
        "later than it may: not followed; give it again, or bess-edge hold --release");
    return true;
  }
  if (now.held) {
    const bool is_same =
        before.held && before.power_w == now.power_w && before.until_utc_s == now.until_utc_s;
    if (is_same) return false;
    line.add("hold: %d W until %s%s", now.power_w, utc_text(now.until_utc_s).c_str(),
             is_in_control ? "" : " (read-only: nothing is written)");
    return true;
  }
  if (before.held) {
    const bool is_early = record.utc_s < std::int64_t{before.until_utc_s};
    line.add("hold: %s; the prices decide again", is_early ? "released" : "over");
    return true;
  }
  if (before.unreadable) line.add("hold: none; the prices decide again");
  return before.unreadable;
}

bool MeterLines::add_trust_line(const CycleRecord& record, TextBuffer& line) {
  if (record.mode == Mode::kStopping) return false;  // nothing was measured; the next run goes on
  const MeterTrust& trust = record.site.trust;
  if (std::exchange(was_mismatch_, trust.is_mismatch) == trust.is_mismatch) return false;
  if (trust.is_mismatch) {
    line.add(
        "meter: it does not step with the battery: frozen, inverted, late, of another phase or "
        "ratio, or the battery's measured power is wrong; as good as lost, tried again from %s on",
        utc_text(trust.pause_until_utc_s).c_str());
  } else {
    line.add("meter: it steps with the battery again, and is believed");
  }
  return true;
}

bool MeterLines::add_house_line(const CycleRecord& record, TextBuffer& line) {
  if (record.mode == Mode::kStopping) return false;
  const bool is_implausible = record.site.house_is_implausible;
  if (std::exchange(was_implausible_, is_implausible) == is_implausible) return false;
  if (is_implausible) {
    line.add(
        "meter: grid %d W less battery %d W leaves the house a load below zero: a sign, the phase "
        "or the place of the meter is wrong; where panels do that, set [meter] pv_w_max",
        record.site.grid_power_w, record.measurement.power_w);
  } else {
    line.add("meter: the house's load is plausible again");
  }
  return true;
}

namespace {

/// Of a number as records have it: 1 + index, 0 = none.
const char* name_of(const RunIdentity& identity, int number) {
  const bool is_known = number > 0 && number <= identity.point_names.size();
  return is_known ? identity.point_names[number - 1].c_str() : "a register";
}

}  // namespace

bool ReadingLines::add_lost_line(const CycleRecord& record, const RunIdentity& identity,
                                 TextBuffer& line) {
  const std::int16_t now = record.measurement.lost_point;
  const std::int16_t before = std::exchange(lost_, now);
  if (record.mode == Mode::kStopping || now == before) return false;
  line.add(
      now != 0 ? "battery: %s could not be read, or is not plausible" : "battery: %s is read again",
      name_of(identity, now != 0 ? now : before));
  return true;
}

bool ReadingLines::add_cut_line(const CycleRecord& record, const RunIdentity& identity,
                                TextBuffer& line) {
  if (!record.has_measurement) return false;
  const std::int16_t now = record.measurement.cut_point;
  if (std::exchange(cut_, now) == now || now == 0) return false;
  line.add("battery: %s is beyond its range, and taken for the end of it (SoC %.2f %%)",
           name_of(identity, now), record.measurement.soc_e4 / 100.0);
  return true;
}

}  // namespace bess
