#include "tools/battery_sim/replay_command.h"

#include <fmt/core.h>

#include <cstdio>

#include "shared/host/user_error.h"
#include "shared/utc_text.h"
#include "tools/sim/stop_signal.h"

namespace bess {
namespace {

UtcText time_text(std::int64_t utc_ns) { return utc_text(utc_ns / kNanosecondsPerSecond); }

}  // namespace

void run_replay(const ReplayOptions& options, const BatteryServerSettings& server,
                const ClockOptions& clock_options) {
  const StopSignal stop;
  const ScaledClock clock = clock_options.clock();
  RecordedDevice device(options.path,
                        options.accept_cut ? CutRecording::kAccepted : CutRecording::kRefused);
  ReplayedBus replayed(device, clock);
  static RegisterMap no_points;  // the recording answers
  no_points.unit = device.head().unit;
  SimulatedBattery unused({}, 0.5, clock.now_utc_ns());
  BatteryServer battery(server, no_points, unused, clock);
  battery.replay(replayed);
  const std::string place = server.serial_device.empty()
                                ? fmt::format("{}:{}", server.host, battery.port())
                                : server.serial_device;
  std::printf(
      "bess-sim battery: listening on %s, unit %d, replaying %s, %s, %lld exchanges from %s to "
      "%s%s\n",
      place.c_str(), device.head().unit, options.path.c_str(), device.head().map.c_str(),
      static_cast<long long>(device.exchanges()), time_text(device.first_utc_ns()).c_str(),
      time_text(device.last_utc_ns()).c_str(),
      clock.is_real_time() ? ", which begins at the first request" : "");
  std::fflush(stdout);
  battery.run(stop.fd());
  std::printf("bess-sim battery: stopped\n");
}

}  // namespace bess
