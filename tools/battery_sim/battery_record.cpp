#include "tools/battery_sim/battery_record.h"

#include <fmt/core.h>

#include "shared/host/file.h"
#include "shared/utc_text.h"

namespace bess {

void write_battery_record(const std::string& path, const SimulatedBattery& battery,
                          const HouseLoad* house) {
  std::string text = "minute_utc,energy_wh,soc,commanded_power_w";
  text += house == nullptr ? "\n" : ",house_wh,grid_wh\n";
  for (const MinuteRecord& m : battery.record()) {
    text += fmt::format("{},{:.6f},{:.8f},{:.0f}", utc_text(m.minute_utc_s).view(), m.energy_wh,
                        m.soc_frac, m.commanded_power_w);
    if (house != nullptr) {
      const double house_wh = house->power_w(m.minute_utc_s) / 60;
      text += fmt::format(",{:.6f},{:.6f}", house_wh, house_wh + m.energy_wh);
    }
    text += '\n';
  }
  write_file(path, text);
}

}  // namespace bess
