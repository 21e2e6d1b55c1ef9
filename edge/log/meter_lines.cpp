#include "edge/log/meter_lines.h"

#include <utility>

#include "shared/utc_text.h"

namespace bess {

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

}  // namespace bess
