#include "edge/log/reading_lines.h"

#include <utility>

namespace bess {
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
