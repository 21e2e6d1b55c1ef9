#include "edge/commands/site_check.h"

#include <cstdio>

#include "edge/log/journal.h"
#include "edge/site/house_watch.h"

namespace bess {
namespace {

/// As "127.0.0.1:502" or the serial device.
FixedText<159> place_of(const BatteryLinkSettings& link) {
  char place[160];
  if (link.rtu) {
    std::snprintf(place, sizeof place, "%s", link.device.c_str());
  } else {
    std::snprintf(place, sizeof place, "%s:%d", link.host.c_str(), link.port);
  }
  return FixedText<159>(place);
}

bool complain(const SiteConfig& site, const char* what) {
  report(JournalLevel::kError, "meter at %s, map %s: %s", place_of(site.link).c_str(),
         site.map.name.c_str(), what);
  return false;
}

bool read_own_map(const SiteConfig& site, ModbusMeter& meter, std::int32_t& grid_power_w) {
  IdentityFailure failure;
  Status status = meter.check_identity(failure);
  if (status == Status::kImplausible && failure.check < site.map.identity.size()) {
    return complain(site, site.map.identity[failure.check].hint.c_str());
  }
  if (status == Status::kOk) status = meter.read(grid_power_w);
  return status == Status::kOk || complain(site, status_text(status).data());
}

}  // namespace

bool report_site(const EdgeConfig& config, ModbusBattery& battery, ModbusMeter& meter) {
  const SiteConfig& site = config.site;
  if (site.settings.meter == MeterSource::kNone) return true;
  BatteryMeasurement m;
  const bool has_battery = battery.read(m) == Status::kOk;
  std::int32_t grid_power_w = m.grid_power_w;
  if (site.settings.meter == MeterSource::kMap) {
    if (!read_own_map(site, meter, grid_power_w)) return false;
  } else if (!m.has_grid_power) {
    report(JournalLevel::kError, "meter: the battery's grid point cannot be read");
    return false;
  }
  std::printf("meter      grid %d W (import is positive)", grid_power_w);
  if (has_battery) std::printf(", house %d W", grid_power_w - m.power_w);
  std::printf("\n");
  if (!has_battery || is_plausible_house(grid_power_w, m.power_w, site.settings.pv_w_max)) {
    return true;
  }
  report(JournalLevel::kError,
         "meter: house %d W: a load below zero; the sign of meter or battery, the phase or the "
         "place of the meter is wrong; where panels do that, set [meter] pv_w_max",
         grid_power_w - m.power_w);
  return false;
}

}  // namespace bess
