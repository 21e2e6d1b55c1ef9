#include "edge/log/hold_lines.h"

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

}  // namespace bess
