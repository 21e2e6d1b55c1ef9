#include "tools/battery_sim/battery_record.h"

#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>

#include "shared/utc_text.h"
#include "tools/sim/sim_error.h"

namespace bess {

void write_battery_record(const std::string& path, const SimulatedBattery& battery) {
  std::string text = "minute_utc,energy_wh,soc,commanded_power_w\n";
  for (const MinuteRecord& m : battery.record()) {
    text += fmt::format("{},{:.6f},{:.8f},{:.0f}\n", utc_text(m.minute_utc_s).view(), m.energy_wh,
                        m.soc_frac, m.commanded_power_w);
  }
  const std::string beside = path + ".part." + std::to_string(getpid());
  std::FILE* file = std::fopen(beside.c_str(), "wb");
  if (file == nullptr) sim_fail("{}: cannot write here: {}", path, std::strerror(errno));
  const bool written = std::fwrite(text.data(), 1, text.size(), file) == text.size();
  const bool synced = std::fflush(file) == 0 && fsync(fileno(file)) == 0;
  const bool closed = std::fclose(file) == 0;
  if (!written || !synced || !closed || std::rename(beside.c_str(), path.c_str()) != 0) {
    const int error = errno;
    std::remove(beside.c_str());
    sim_fail("{}: writing failed: {}; nothing was changed", path, std::strerror(error));
  }
}

}  // namespace bess
