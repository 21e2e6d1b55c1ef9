#include "tools/simulators/battery_sim/battery_record.h"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <string_view>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/user_error.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::array<std::string_view, 3> kKindNames = {"order", "stop", "expiry"};

}  // namespace

void write_battery_record(const std::string& path, const std::vector<MinuteRecord>& minutes,
                          const HouseLoad* house) {
  std::string text = "minute_utc,energy_wh,soc,commanded_power_w";
  text += house == nullptr ? "\n" : ",house_wh,grid_wh\n";
  for (const MinuteRecord& m : minutes) {
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
    text += fmt::format("{},{},{:.0f},{},{:.8f}\n", e.utc_ns / 1'000'000,
                        kKindNames[static_cast<std::size_t>(e.kind)], e.power_w, e.duration_s,
                        e.soc_frac);
  }
  write_file(path, text);
}

std::vector<MinuteRecord> read_battery_record(const std::string& path) {
  const CsvTable table = CsvTable::read(path);
  const std::size_t utc = table.column("minute_utc"), energy = table.column("energy_wh");
  const std::size_t soc = table.column("soc"), power = table.column("commanded_power_w");
  std::vector<MinuteRecord> minutes;
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    minutes.push_back({.minute_utc_s = table.utc_s(r, utc),
                       .energy_wh = table.number(r, energy),
                       .soc_frac = table.number(r, soc),
                       .commanded_power_w = table.number(r, power)});
  }
  return minutes;
}

std::vector<DispatchEvent> read_dispatch_events(const std::string& path) {
  const std::string text = read_file(path);
  if (std::ranges::count(text, '\n') < 2) return {};  // no order was ever given
  const CsvTable table(text, path);
  const std::size_t utc = table.column("utc_ms"), event = table.column("event");
  const std::size_t power = table.column("power_w"), duration = table.column("duration_s");
  const std::size_t soc = table.column("soc");
  std::vector<DispatchEvent> events;
  for (std::size_t r = 0; r < table.row_count(); ++r) {
    const auto kind = std::ranges::find(kKindNames, table.text(r, event));
    if (kind == kKindNames.end()) fail("{}: unknown event \"{}\"", path, table.text(r, event));
    events.push_back({.utc_ns = static_cast<std::int64_t>(table.number(r, utc)) * 1'000'000,
                      .kind = static_cast<DispatchEvent::Kind>(kind - kKindNames.begin()),
                      .power_w = table.number(r, power),
                      .duration_s = static_cast<std::int64_t>(table.number(r, duration)),
                      .soc_frac = table.number(r, soc)});
  }
  return events;
}

}  // namespace bess
