#include "shared/host/bus_recording.h"

#include <cerrno>
#include <cmath>
#include <cstring>

#include "shared/host/json.h"
#include "shared/scaled_clock.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::size_t kLineBytesMax = 4'096;

/// Whole number in a range; false if the member is missing or something else.
template <typename Whole>
bool take_whole(JsonValue object, const char* key, std::int64_t min, std::int64_t max,
                Whole& value) {
  const double number = object[key].number().value_or(0.5);
  if (number != std::floor(number)) return false;
  if (number < static_cast<double>(min) || number > static_cast<double>(max)) return false;
  value = static_cast<Whole>(number);
  return true;
}

/// "2026-11-22T06:00:01.204511Z"; with up to nine decimals.
bool parse_utc_ns(std::string_view text, std::int64_t& utc_ns) {
  std::int64_t utc_s = 0;
  if (!parse_utc(text, utc_s)) return false;
  utc_ns = utc_s * kNanosecondsPerSecond;
  const std::size_t point = text.find('.');
  std::int64_t digit_ns = kNanosecondsPerSecond / 10;
  for (std::size_t i = point; point != text.npos && ++i < text.size(); digit_ns /= 10) {
    if (text[i] < '0' || text[i] > '9') break;
    utc_ns += (text[i] - '0') * digit_ns;
  }
  return true;
}

/// Outcome of a line; false if unknown.
bool take_outcome(JsonValue object, BusExchange& exchange) {
  exchange.exception = 0;
  exchange.outcome = BusOutcome::kAnswered;
  if (object["exception"].exists()) {
    exchange.outcome = BusOutcome::kException;
    return take_whole(object, "exception", 1, 255, exchange.exception);
  }
  if (!object["error"].exists()) return true;
  const std::string_view name = object["error"].text_or("");
  for (std::size_t i = 2; i < kBusOutcomeNames.size(); ++i) {
    if (name != kBusOutcomeNames[i]) continue;
    exchange.outcome = static_cast<BusOutcome>(i);
    return true;
  }
  return false;
}

/// `count` numbers of 16 bits.
bool take_values(JsonValue list, BusExchange& exchange) {
  if (exchange.values().empty()) return !list.exists();
  if (!list.is_list() || list.size() != exchange.count) return false;
  std::size_t i = 0;
  for (const JsonValue item : list) {
    const double number = item.number().value_or(0.5);
    if (!(number >= 0 && number <= 0xFFFF) || number != std::floor(number)) return false;
    exchange.registers[i++] = static_cast<std::uint16_t>(number);
  }
  return true;
}

/// Error of a line; "": none.
std::string_view parse_exchange(JsonValue object, BusExchange& exchange) {
  if (!object.is_object()) return "not a line of a recording";
  if (!parse_utc_ns(object["utc"].text_or(""), exchange.utc_ns)) return "\"utc\" is not a UTC time";
  if (!take_whole(object, "unit", 0, 255, exchange.unit)) return "\"unit\" must be 0 to 255";
  if (!take_whole(object, "function", 3, 16, exchange.function) ||
      (exchange.function != 3 && exchange.function != 4 && !exchange.is_write())) {
    return "\"function\" must be 3, 4, 6 or 16";
  }
  if (!take_whole(object, "address", 0, 65'535, exchange.address))
    return "\"address\" must be 0 to 65535";
  if (!take_whole(object, "count", 1, BusExchange::kRegistersMax, exchange.count)) {
    return "\"count\" must be 1 to 125";
  }
  if (exchange.address + exchange.count > 65'536) return "\"address\" + \"count\" exceed 65536";
  if (!take_whole(object, "latency_us", 0, 3'600'000'000LL, exchange.latency_us)) {
    return "\"latency_us\" must be 0 to 3600000000";
  }
  if (!take_outcome(object, exchange)) return "unknown \"exception\" or \"error\"";
  if (!take_values(object["values"], exchange)) {
    return "\"values\" must be \"count\" numbers from 0 to 65535";
  }
  return "";
}

bool parse_head(JsonValue object, RecordingHead& head) {
  int version = 0;
  const JsonValue groups = object["units"];
  const std::string_view transport = object["transport"].text_or("");
  if (!take_whole(object, "bess_recording", kRecordingVersion, kRecordingVersion, version) ||
      !take_whole(object, "unit", 0, 255, head.unit) ||
      !take_whole(object, "time_scale", 1, 100'000, head.time_scale) || !groups.is_object() ||
      (transport != "tcp" && transport != "rtu") ||
      !parse_utc(object["begin"].text_or(""), head.begin_utc_s)) {
    return false;
  }
  head.version = object["version"].text_or("");
  head.map = object["map"].text_or("");
  head.variant = object["variant"].text_or("");
  head.rtu = transport == "rtu";
  for (const JsonValue group : groups) {
    const double id = group.number().value_or(-1);
    if (!(id >= 0 && id <= 255)) return false;
    head.units.emplace_back(group.key(), static_cast<std::int32_t>(id));
  }
  return true;
}

}  // namespace

std::string format_recording_head(const RecordingHead& head) {
  Json units = Json::object();
  for (const auto& [name, unit] : head.units) units.set(name.c_str(), unit);
  return Json::object({{"bess_recording", kRecordingVersion},
                       {"version", head.version},
                       {"map", head.map},
                       {"variant", head.variant},
                       {"unit", head.unit},
                       {"units", std::move(units)},
                       {"transport", head.rtu ? "rtu" : "tcp"},
                       {"begin", utc_text(head.begin_utc_s).view()},
                       {"time_scale", head.time_scale}})
      .line();
}

bool BusRecordingReader::open(const std::string& path, CutRecording cut, std::string& error) {
  path_ = path;
  cut_ = cut;
  file_.open(path);
  if (!file_) {
    error = path + ": cannot be read: " + std::strerror(errno);
    return false;
  }
  std::string line;
  const bool is_whole = take_line(line) && !is_torn_;
  if (is_whole && parse_head(Json::parse(line).value(), head_)) return true;
  error = path + ":1: not a recording of bess-edge (version " + std::to_string(kRecordingVersion) +
          "): make one with bess-edge record";
  return false;
}

BusRecordingReader::Next BusRecordingReader::next(BusExchange& exchange, std::string& error) {
  std::string line;
  if (!take_line(line)) return end_of_file(error);
  const Json json = Json::parse(line);
  if (is_torn_) return end_of_file(error);
  if (json.value()["end"].exists()) return end_line(json.value(), error);
  const std::string_view wrong = parse_exchange(json.value(), exchange);
  if (!wrong.empty()) return refuse(std::string(wrong), error);
  ++exchanges_;
  return Next::kExchange;
}

/// False at the end of the file. A line that is too long ends there.
bool BusRecordingReader::take_line(std::string& line) {
  char c = '\0';
  ++line_number_;
  is_torn_ = false;
  while (file_.get(c)) {
    if (c == '\n') return true;
    line.push_back(c);
    if (line.size() > kLineBytesMax) return true;  // not JSON then
  }
  is_torn_ = !line.empty();
  return is_torn_;
}

BusRecordingReader::Next BusRecordingReader::refuse(const std::string& what,
                                                    std::string& error) const {
  error = path_ + ":" + std::to_string(line_number_) + ": " + what +
          ": the recording is damaged; record or copy it again";
  return Next::kDamaged;
}

BusRecordingReader::Next BusRecordingReader::end_of_file(std::string& error) {
  if (cut_ == CutRecording::kAccepted) {
    was_cut_ = true;
    return Next::kEnd;
  }
  error = path_ + ":" + std::to_string(line_number_) +
          ": the recording ends here, without its last line; --accept-cut accepts the " +
          std::to_string(exchanges_) + " exchanges before this line";
  return Next::kDamaged;
}

BusRecordingReader::Next BusRecordingReader::end_line(const JsonValue& object, std::string& error) {
  std::int64_t counted = 0;
  constexpr std::int64_t kMost = std::int64_t{1} << 50;
  if (!take_whole(object, "exchanges", 0, kMost, counted) ||
      !take_whole(object, "dropped", 0, kMost, dropped_)) {
    return refuse("the last line has no number of exchanges", error);
  }
  if (counted != exchanges_) {
    return refuse("the last line states " + std::to_string(counted) + " exchanges, found " +
                      std::to_string(exchanges_),
                  error);
  }
  std::string rest;
  if (take_line(rest)) return refuse("data after the last line", error);
  return Next::kEnd;
}

}  // namespace bess
