#include "edge/app/recording/exchange_recorder.h"

#include <unistd.h>

#include <cerrno>
#include <cinttypes>
#include <cstdio>

#include "edge/records/log/journal.h"
#include "edge/records/log/text_buffer.h"
#include "shared/utc_text.h"

namespace bess {
namespace {

constexpr std::size_t kLineBytesMax =
    1'280;                                 // 125 values of five digits, and the fields before them
constexpr std::size_t kEndBytesMax = 128;  // kept free of `bytes_max` for the last line

std::int64_t since_second_us(std::int64_t utc_ns) { return utc_ns % kNanosecondsPerSecond / 1'000; }

/// Line of one exchange, with line end.
void add_line(const BusExchange& e, TextBuffer& line) {
  const UtcText second = utc_text(e.utc_ns / kNanosecondsPerSecond);
  line.add("{\"utc\":\"%.19s.%06" PRId64
           "Z\",\"unit\":%d,\"function\":%u,\"address\":%u,"
           "\"count\":%u,\"latency_us\":%" PRId64,
           second.c_str(), since_second_us(e.utc_ns), e.unit, e.function, e.address, e.count,
           e.latency_us);
  if (e.outcome == BusOutcome::kException) {
    line.add(",\"exception\":%d", e.exception);
  } else if (e.outcome != BusOutcome::kAnswered) {
    line.add(",\"error\":\"%s\"", kBusOutcomeNames[static_cast<std::size_t>(e.outcome)].data());
  }
  const char* before = ",\"values\":[";
  for (const std::uint16_t value : e.values()) {
    line.add("%s%u", before, value);
    before = ",";
  }
  line.add("%s}\n", e.values().empty() ? "" : "]");
}

}  // namespace

RecordingHead recording_head_of(const RegisterMap& map, const BatteryLinkSettings& link,
                                const ScaledClock& clock) {
  RecordingHead head{.version = BESS_VERSION,
                     .map = std::string(map.name.view()),
                     .variant = std::string(map.variant.view()),
                     .unit = link.unit >= 0 ? link.unit : map.unit,
                     .units = {},
                     .rtu = link.rtu,
                     .begin_utc_s = utc_seconds(clock),
                     .time_scale = clock.scale};
  for (const UnitGroup& group : map.unit_groups) {
    head.units.emplace_back(group.name.view(), group.unit);
  }
  return head;
}

ExchangeRecorder::~ExchangeRecorder() {
  FileMessage ignored;  // already in the journal
  static_cast<void>(finish(ignored));
}

bool ExchangeRecorder::start(const char* path, const RecordingHead& head, const RegisterMap& map,
                             const ScaledClock& clock, FileMessage& error, std::int64_t bytes_max) {
  if (!path_.assign(path) || !part_path_.assign(std::string(path) + ".part")) {
    errno = ENAMETOOLONG;
    return fail_with_errno(path, "cannot create the recording", error);
  }
  fd_ = make_afresh(part_path_.c_str());
  if (fd_ < 0) return fail_with_errno(part_path_.c_str(), "cannot create the recording", error);
  clock_ = clock;
  bytes_max_ = bytes_max;
  mask_.emplace(map, head.unit);
  is_writing_ = true;
  const std::string first = format_recording_head(head) + "\n";
  if (!write_line(first)) {
    return fail_with_errno(part_path_.c_str(), "cannot be written", error);
  }
  queue_.start<&ExchangeRecorder::keep>(this);
  return true;
}

ExchangeListener ExchangeRecorder::listener() {
  return {.on_exchange =
              [](void* recorder, const BusExchange& exchange) {
                static_cast<ExchangeRecorder*>(recorder)->push(exchange);
              },
          .owner = this};
}

void ExchangeRecorder::push(BusExchange exchange) {
  exchange.utc_ns = clock_.now_utc_ns() - exchange.latency_us * 1'000 * clock_.scale;
  if (!queue_.push(exchange)) ++dropped_;
}

void ExchangeRecorder::keep(BusExchange& exchange) {
  if (!is_writing_) return;
  mask_->apply(exchange);
  char text[kLineBytesMax];
  TextBuffer line(text);
  add_line(exchange, line);
  if (bytes_ + static_cast<std::int64_t>(line.view().size() + kEndBytesMax) > bytes_max_) {
    return stop_writing("has reached its maximum size: recording ends");
  }
  if (write_line(line.view())) {
    ++written_;
  } else {
    has_failed_ = true;
    stop_writing("cannot be written (is the disk full?): recording ends");
  }
}

bool ExchangeRecorder::write_line(std::string_view line) {
  if (!append_whole(fd_, line)) return false;
  bytes_ += static_cast<std::int64_t>(line.size());
  return true;
}

void ExchangeRecorder::stop_writing(const char* why) {
  is_writing_ = false;
  char text[640];
  TextBuffer line(text);
  line.add("recording %s %s", path_.c_str(), why);
  write_journal_line(JournalLevel::kWarning, line.view());
}

bool ExchangeRecorder::write_end() {
  char text[kEndBytesMax];
  TextBuffer line(text);
  line.add("{\"end\":\"%s\",\"exchanges\":%" PRId64 ",\"dropped\":%" PRId64 "}\n",
           utc_text(utc_seconds(clock_)).c_str(), written_.load(), dropped_.load());
  return write_line(line.view());
}

bool ExchangeRecorder::finish(FileMessage& error) {
  if (fd_ < 0) return true;
  queue_.finish();
  const bool is_whole = !has_failed_ && write_end() && fsync(fd_) == 0;
  const int cause = errno;
  close(fd_);
  fd_ = -1;
  if (!is_whole) {
    errno = cause;
    return fail_with_errno(part_path_.c_str(), "incomplete recording", error);
  }
  if (rename(part_path_.c_str(), path_.c_str()) != 0) {
    return fail_with_errno(path_.c_str(), "cannot rename the recording", error);
  }
  sync_folder_of(path_.c_str());
  return true;
}

}  // namespace bess
