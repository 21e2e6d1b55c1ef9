// bess-edge record: reads what the register map names, again and again, and writes every request
// and reply to a file that can be given away. Writes nothing to the device. `bess-edge
// --record` records a controller at work.
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

struct RecordGiven {
  std::string out_path;      ///< empty = a name made of the time
  std::int64_t for_s = 0;    ///< 0 = not given
  std::int64_t every_s = 0;  ///< 0 = not given
};

constexpr const char* kFooter =
    R"(One JSON object a line: request, values or error, latency. Hidden (0, of a text X) is what
the map marks as private, texts beyond what the map's identity check asks for, and every register
that the map does not name: the file can be given away. It holds neither network addresses nor
prices. Refused while another bess-edge has the battery: record that one with bess-edge --record
FILE, which has the orders too. bess-sim battery --replay FILE and bess-edge map check read it.
Exit codes:
  0 recorded
  1 the file cannot be written, the battery did not answer, or it is in use
  2 the command line is wrong
Examples:
  bess-edge record --for 1h
  bess-edge record --for 5m --every 2s --out inverter.jsonl --config /etc/bess/edge.toml)";

constexpr std::int64_t kEveryDefaultS = 10;
constexpr std::int64_t kAllEveryS =
    600;  ///< also what does not change: identity, scales, written registers

using Bus = BatteryBus<ModbusLink, DeviceTime>;

/// "bess-20261122T060000Z.jsonl" in the current folder, unless the command line names a file.
std::string path_of(const RecordGiven& given, std::int64_t utc_s) {
  if (!given.out_path.empty()) return given.out_path;
  std::string name(utc_text(utc_s).view());
  std::erase_if(name, [](char c) { return c == '-' || c == ':'; });
  return "bess-" + name + ".jsonl";
}

/// Where the SunSpec models lie, and every point by itself, so that one that is refused takes no
/// other with it. What a command would write is asked for as the holding register that it is.
void read_everything(const RegisterMap& map, const PointPlaces& places, Bus& bus,
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
void poll_device(const RecordGiven& given, const EdgeConfig& config, Bus& bus, EdgeClock& clock) {
  const std::int64_t every_s = given.every_s > 0 ? given.every_s : kEveryDefaultS;
  const std::int64_t begin_ns = clock.now_utc_ns();
  const std::int64_t end_ns = begin_ns + given.for_s * kNanosecondsPerSecond;
  const PointPlaces places(config.battery.map, config.battery.link.unit);
  const Progress progress(given.for_s);
  std::int64_t next_all_ns = begin_ns;
  std::int64_t next_ns = begin_ns;
  while (!clock.stop_requested()) {
    if (next_ns >= next_all_ns) {
      read_everything(config.battery.map, places, bus, clock);
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

int run_record(const RecordGiven& given, SettingsFile& settings) {
  const EdgeConfig& config = settings.config;
  DeviceSession session;
  if (!session.begin(config)) return 1;
  EdgeClock& clock = session.clock();
  const RecordingHead head =
      recording_head_of(config.battery.map, config.battery.link, config.clock);
  const std::string path = path_of(given, head.begin_utc_s);
  const auto recorder = std::make_unique<ExchangeRecorder>();
  FileMessage error;
  if (!recorder->start(path.c_str(), head, config.battery.map, config.clock, error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  Bus bus(config.battery.map, DeviceTime(config.clock), config.battery.link.unit,
          config.battery.link, timing_of(config.battery.map), config.clock);
  bus.link().tell_exchanges(recorder->listener());
  poll_device(given, config, bus, clock);
  bus.link().tell_exchanges({});
  if (!recorder->finish(error)) {
    report(JournalLevel::kError, "%s", error.c_str());
    return 1;
  }
  const LinkCounters& counters = bus.link().counters();
  std::printf("recorded   %s: %" PRId64 " requests, %" PRId64
              " failed; nothing was written to %s\n",
              path.c_str(), counters.requests, counters.failed_requests,
              battery_place(config.battery).c_str());
  if (counters.failed_requests < counters.requests) return 0;
  report(JournalLevel::kError,
         "battery at %s: no request had a good answer (are host, port and unit right, does another "
         "program "
         "hold its one connection?)",
         battery_place(config.battery).c_str());
  return 1;
}

}  // namespace

void add_record(EdgeCommand root) {
  EdgeCommand command =
      root.subcommand("record", "record what a battery answers, without writing to it");
  const auto given = std::make_shared<RecordGiven>();
  command.duration("--for", given->for_s, 1, "how long, 1s to 7d; Ctrl-C ends it before")
      .required();
  command.duration("--every", given->every_s, 1,
                   "between two readings of measured values; default 10s. All other registers of "
                   "the map are read every 10 minutes");
  command.option("--out", given->out_path, "default: bess-TIME.jsonl in the current folder")
      .value_name("FILE");
  command.footer(kFooter);
  command.does([given](SettingsFile& settings) { return run_record(*given, settings); });
}

}  // namespace bess
