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

void write_dispatch_events(const std::string& path, const SimulatedBattery& battery) {
  std::string text = "utc_ms,event,power_w,duration_s,soc\n";
  for (const DispatchEvent& e : battery.dispatch_events()) {
    const char* const name = e.kind == DispatchEvent::Kind::kOrder  ? "order"
                             : e.kind == DispatchEvent::Kind::kStop ? "stop"
                                                                    : "expiry";
    text += fmt::format("{},{},{:.0f},{},{:.8f}\n", e.utc_ns / 1'000'000, name, e.power_w,
                        e.duration_s, e.soc_frac);
  }
  write_file(path, text);
}

}  // namespace bess
