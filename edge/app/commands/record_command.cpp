// Recording of a battery's Modbus answers, without writing to it: `bess-edge record`. The file has
// no private data. `bess-edge --record` records a running controller.
#include <unistd.h>

#include <algorithm>
#include <cinttypes>
#include <cstdio>
#include <memory>

#include "edge/app/commands/command.h"
#include "edge/app/program/find_battery.h"
#include "edge/app/recording/exchange_recorder.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/records/log/journal.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

struct RecordOptions {
  std::string out_path;      ///< empty = name from the time
  std::int64_t for_s = 0;    ///< 0 = not given
  std::int64_t every_s = 0;  ///< 0 = not given
};

constexpr const char* kRecordFooter =
    R"(One JSON object per line: request, values or error, latency. The file can be shared:
registers that the map does not name or marks as private are 0, texts that the identity check does
not need are X; it has no network addresses and no prices. Refused while another bess-edge uses the
battery: record that controller with bess-edge --record FILE, which includes the orders. Use the
file with bess-sim battery --replay FILE or bess-edge map check.
Exit codes:
  0 recorded
  1 file not writable, no answer from the battery, or battery in use
  2 command line error
Examples:
  bess-edge record --for 1h
  bess-edge record --for 5m --every 2s --out inverter.jsonl --config /etc/bess/edge.toml)";

constexpr std::int64_t kEveryDefaultS = 10;
constexpr std::int64_t kAllEveryS =
    600;  ///< for all points, also constant ones: identity, scales, written registers

using Bus = BatteryBus<ModbusLink, DeviceTime>;

/// Default: "bess-20261122T060000Z.jsonl" in the current folder.
std::string path_of(const RecordOptions& options, std::int64_t utc_s) {
  if (!options.out_path.empty()) return options.out_path;
  std::string name(utc_text(utc_s).view());
  std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
  return "bess-" + name + ".jsonl";
}

/// Locates the SunSpec models and reads each point separately, so that a refused point affects no
/// other. Points that commands write are read as holding registers.
void read_all_points(const RegisterMap& map, const PointPlaces& places, Bus& bus,
                     EdgeClock& clock) {
  std::uint16_t missing_model = 0;
  static_cast<void>(bus.locate_models(missing_model));
  for (int i = 0; i < map.points.size() && !clock.stop_requested(); ++i) {
    const auto point = static_cast<std::int8_t>(i);
    std::uint16_t registers[kTextRegistersMax] = {};
    static_cast<void>(bus.read_point(point, registers));
    if (!places.is_written(i) || map.points[i].read_function == 3) continue;
    static_cast<void>(bus.link().read(bus.placed(point, 3).place, registers));
  }
}

/// Progress line on a terminal.
class Progress {
 public:
  explicit Progress(std::int64_t for_s) : for_s_(for_s), is_shown_(isatty(STDERR_FILENO) == 1) {}
  void show(std::int64_t passed_s, const BatteryCounters& counters) const {
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

/// Until the end time or a stop request.
void poll_device(const RecordOptions& options, const EdgeConfig& config, Bus& bus,
                 EdgeClock& clock) {
  const std::int64_t every_s = options.every_s > 0 ? options.every_s : kEveryDefaultS;
  const std::int64_t begin_ns = clock.now_utc_ns();
  const std::int64_t end_ns = begin_ns + options.for_s * kNanosecondsPerSecond;
  const PointPlaces places(config.battery.map, config.battery.link.unit);
  const Progress progress(options.for_s);
  std::int64_t next_all_ns = begin_ns;
  std::int64_t next_ns = begin_ns;
  while (!clock.stop_requested()) {
    if (next_ns >= next_all_ns) {
      read_all_points(config.battery.map, places, bus, clock);
      next_all_ns += kAllEveryS * kNanosecondsPerSecond;
    }
    static_cast<void>(bus.read_due());
    const std::int64_t now_ns = clock.now_utc_ns();
    progress.show((now_ns - begin_ns) / kNanosecondsPerSecond, bus.link().counters());
    // A device slower than `every` is read as often as it answers.
    next_ns = std::max(next_ns + every_s * kNanosecondsPerSecond, now_ns);
    if (next_ns >= end_ns || !clock.sleep_until_utc_ns(next_ns)) break;
  }
  progress.end();
}

int run_record(const RecordOptions& options, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  DeviceSession session;
  if (!session.begin(config)) return 1;
  EdgeClock& clock = *session.clock;
  const RecordingHead head =
      recording_head_of(config.battery.map, config.battery.link, config.clock);
  const std::string path = path_of(options, head.begin_utc_s);
  const auto recorder = std::make_unique<ExchangeRecorder>();
  FileMessage error;
  if (!recorder->start(path.c_str(), head, config.battery.map, config.clock, error)) {
    return failed(error.c_str());
  }
  Bus bus(config.battery.map, DeviceTime(config.clock), config.battery.link.unit,
          config.battery.link, timing_of(config.battery.map), config.clock);
  bus.link().set_exchange_listener(recorder->listener());
  poll_device(options, config, bus, clock);
  bus.link().set_exchange_listener({});
  if (!recorder->finish(error)) return failed(error.c_str());
  const BatteryCounters& counters = bus.link().counters();
  std::printf("recorded   %s: %" PRId64 " requests, %" PRId64
              " failed; nothing was written to %s\n",
              path.c_str(), counters.requests, counters.failed_requests,
              battery_place(config.battery).c_str());
  if (counters.failed_requests < counters.requests) return 0;
  report(JournalLevel::kError,
         "battery at %s: no request succeeded: check host, port and unit, and whether another "
         "program uses its only connection",
         battery_place(config.battery).c_str());
  return 1;
}

}  // namespace

void add_record(EdgeCommand root) {
  EdgeCommand command = root.subcommand("record", "record a battery's Modbus answers (read-only)");
  const auto options = std::make_shared<RecordOptions>();
  command.duration("--for", options->for_s, 1, "duration, 1s to 7d; Ctrl-C ends it earlier")
      .required();
  command.duration("--every", options->every_s, 1,
                   "interval between readings of measured values; default: 10s. Other registers of "
                   "the map: every 10 minutes");
  command
      .option("--out", options->out_path,
              "output file; default: bess-TIME.jsonl in the current folder")
      .value_name("FILE");
  command.footer(kRecordFooter);
  command.set_action([options](SettingsFile& settings) { return run_record(*options, settings); });
}

}  // namespace bess
