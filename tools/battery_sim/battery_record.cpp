#include "tools/battery_sim/battery_record.h"

#include <fmt/core.h>

#include "shared/host/file.h"
#include "shared/utc_text.h"

namespace bess {

void write_battery_record(const std::string& path, const SimulatedBattery& battery) {
  std::string text = "minute_utc,energy_wh,soc,commanded_power_w\n";
  for (const MinuteRecord& m : battery.record()) {
    text += fmt::format("{},{:.6f},{:.8f},{:.0f}\n", utc_text(m.minute_utc_s).view(), m.energy_wh,
                        m.soc_frac, m.commanded_power_w);
  }
  write_file(path, text);
}

}  // namespace bess
