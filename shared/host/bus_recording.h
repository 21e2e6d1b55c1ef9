// Recording of a Modbus device, JSON lines: a head, one line for each request with its result, and
// a last line with their number:
//   {"bess_recording":1,"version":"0.1.0","map":"alphaess","variant":"block","unit":85,"units":{},
//    "transport":"tcp","begin":"2026-11-22T06:00:00Z","time_scale":1}
//   {"utc":"2026-11-22T06:00:01.204511Z","unit":85,"function":3,"address":258,"count":1,"latency_us":8120,
//    "values":[435]}
//   {"utc":...,"unit":85,"function":3,"address":9999,"count":1,"latency_us":7300,"exception":2}
//   {"utc":...,"unit":85,"function":3,"address":258,"count":1,"latency_us":1000000,"error":"timeout"}
//   {"end":"2026-11-22T07:00:00Z","exchanges":3,"dropped":0}
// Addresses are PDU addresses. `values` were read or written. `dropped` counts exchanges that were
// too fast for the disk.
#pragma once

#include <cstdint>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "shared/bus_exchange.h"

namespace bess {

class JsonValue;

inline constexpr int kRecordingVersion = 1;

struct RecordingHead {
  std::string version{};  ///< of the recording program
  std::string map{};
  std::string variant{};
  std::int32_t unit = 1;
  std::vector<std::pair<std::string, std::int32_t>> units{};  ///< unit groups of the map
  bool rtu = false;
  std::int64_t begin_utc_s = 0;
  std::int32_t time_scale = 1;  ///< of the edge's clock: latencies are wall time
};

/// First line, without line end.
std::string format_recording_head(const RecordingHead& head);

/// Whether a recording without its last line is accepted.
enum class CutRecording { kRefused, kAccepted };

/// Reads one line at a time: a recording may be larger than memory.
class BusRecordingReader {
 public:
  /// False with one line ("FILE:1: error; remedy").
  bool open(const std::string& path, CutRecording cut, std::string& error);
  [[nodiscard]] const RecordingHead& head() const { return head_; }

  enum class Next { kExchange, kEnd, kDamaged };
  /// kDamaged: `error` has one line with file and line.
  Next next(BusExchange& exchange, std::string& error);

  [[nodiscard]] std::int64_t exchanges() const { return exchanges_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }
  [[nodiscard]] bool was_cut() const { return was_cut_; }

 private:
  bool take_line(std::string& line);
  Next refuse(const std::string& what, std::string& error) const;
  Next end_of_file(std::string& error);
  Next end_line(const JsonValue& object, std::string& error);

  std::ifstream file_;
  std::string path_;
  CutRecording cut_ = CutRecording::kRefused;
  RecordingHead head_;
  std::int64_t line_number_ = 0;
  std::int64_t exchanges_ = 0;
  std::int64_t dropped_ = 0;
  bool is_torn_ = false;  ///< the last line read has no line end
  bool was_cut_ = false;
};

}  // namespace bess
