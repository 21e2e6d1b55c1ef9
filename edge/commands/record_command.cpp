#include "edge/commands/record_command.h"

#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>

#include "edge/battery/modbus_battery.h"
#include "edge/log/journal.h"
#include "edge/recording/exchange_recorder.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::int64_t kEveryDefaultS = 10;
constexpr std::int64_t kAllEveryS =
    600;  ///< also what does not change: identity, scales, written registers

using Bus = BatteryBus<ModbusLink, DeviceTime>;

/// "bess-20261122T060000Z.jsonl" in the current folder, unless the command line names a file.
std::string path_of(const CommandLine& command_line, std::int64_t utc_s) {
  if (!command_line.out_path.empty()) return command_line.out_path;
  std::string name(utc_text(utc_s).view());
  std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
  return "bess-" + name + ".jsonl";
}

/// Where the SunSpec models lie, and every point by itself, so that one that is refused takes no other with it.
/// What a command would write is asked for as the holding register that it is.
void read_everything(const RegisterMap& map, const PointPlaces& places, Bus& bus,
                     EdgeClock& clock) {
  static_cast<void>(bus.locate_models());
  for (int i = 0; i < map.points.size() && !clock.stop_requested(); ++i) {
    const auto point = static_cast<std::int8_t>(i);
    std::uint16_t registers[kTextRegistersMax] = {};
    static_cast<void>(bus.read_point(point, registers));
    if (!places.is_written(i) || map.points[i].read_function == 3) continue;
    static_cast<void>(bus.link().read(bus.placed(point, 3).place, registers));
  }
}

/// On a terminal: how far it is, how fast, and how long it still takes.
class Progress {
 public:
  explicit Progress(std::int64_t for_s) : for_s_(for_s), is_shown_(isatty(STDERR_FILENO) == 1) {}
  void show(std::int64_t passed_s, const LinkCounters& counters) const {
    if (!is_shown_ || passed_s < 2) return;
    std::fprintf(stderr,
                 "\rrecording  %" PRId64 " of %" PRId64 " s, %" PRId64
                 " requests (%.1f a second), "
                 "%" PRId64 " failed, %" PRId64 " s left   ",
                 passed_s, for_s_, counters.requests,
                 static_cast<double>(counters.requests) / static_cast<double>(passed_s),
                 counters.failed_requests, std::max<std::int64_t>(for_s_ - passed_s, 0));
  }
  void end() const {
    if (is_shown_) std::fputc('\n', stderr);
  }

 private:
  std::int64_t for_s_;
  bool is_shown_;
};

/// Until the time is over, or somebody stops it.
void poll_device(const CommandLine& command_line, const EdgeConfig& config, Bus& bus,
                 EdgeClock& clock) {
  const std::int64_t every_s = command_line.every_s > 0 ? command_line.every_s : kEveryDefaultS;
  const std::int64_t begin_ns = clock.now_utc_ns();
  const std::int64_t end_ns = begin_ns + command_line.for_s * kNanosecondsPerSecond;
  const PointPlaces places(config.map, config.link.unit);
  const Progress progress(command_line.for_s);
  std::int64_t next_all_ns = begin_ns;
  std::int64_t next_ns = begin_ns;
  while (!clock.stop_requested()) {
    if (next_ns >= next_all_ns) {
      read_everything(config.map, places, bus, clock);
      next_all_ns += kAllEveryS * kNanosecondsPerSecond;
    }
    static_cast<void>(bus.read_due());
    const std::int64_t now_ns = clock.now_utc_ns();
    progress.show((now_ns - begin_ns) / kNanosecondsPerSecond, bus.link().counters());
    // A device that is slower than `every` is asked as often as it answers.
    next_ns = std::max(next_ns + every_s * kNanosecondsPerSecond, now_ns);
    if (next_ns >= end_ns || !clock.sleep_until_utc_ns(next_ns)) break;
  }
  progress.end();
}

}  // namespace

int run_record_command(const CommandLine& command_line, const EdgeConfig& config,
                       EdgeClock& clock) {
  const RecordingHead head = recording_head_of(config.map, config.link, config.clock);
  const std::string path = path_of(command_line, head.begin_utc_s);
  static ExchangeRecorder recorder;
  FileMessage error;
  if (!recorder.start(path.c_str(), head, config.map, config.clock, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  static Bus bus(config.map, DeviceTime(config.clock), config.link.unit, config.link,
                 timing_of(config.map), config.clock);
  bus.link().tell_exchanges(recorder.listener());
  poll_device(command_line, config, bus, clock);
  bus.link().tell_exchanges({});
  if (!recorder.finish(error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  const LinkCounters& counters = bus.link().counters();
  std::printf(
      "recorded   %s: %" PRId64 " requests, %" PRId64 " failed; nothing was written to %s\n",
      path.c_str(), counters.requests, counters.failed_requests, battery_place(config).c_str());
  if (counters.failed_requests < counters.requests) return 0;
  report(JournalLevel::kError,
         "battery at %s: no request had a good answer (are host, port and unit right, does another "
         "program "
         "hold its one connection?)",
         battery_place(config).c_str());
  return 1;
}

}  // namespace bess
