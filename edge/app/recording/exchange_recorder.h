// Writes what a Modbus link says and hears to a recording (shared/host/bus_recording.h), for a
// device that is somewhere else. The link's thread leaves each exchange in a fixed queue and goes
// on; a thread on a static stack hides what is private and writes, so that no disk holds up an
// order. What does not fit is dropped and counted. Written to FILE.part and renamed at the end; a
// process that dies leaves FILE.part, cut behind a whole line.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string>

#include "edge/app/recording/recording_mask.h"
#include "edge/core/memory/plain_thread.h"
#include "edge/device/battery/modbus_link.h"
#include "edge/records/log/handover_queue.h"
#include "edge/records/log/whole_file.h"
#include "shared/host/bus_recording.h"
#include "shared/scaled_clock.h"

namespace bess {

/// What the first line of a recording of this battery says.
RecordingHead recording_head_of(const RegisterMap& map, const BatteryLinkSettings& link,
                                const ScaledClock& clock);

inline constexpr std::int64_t kRecordingBytesMax = 256 << 20;  ///< a quarter of a year, or more

class ExchangeRecorder {
 public:
  ExchangeRecorder() = default;
  ExchangeRecorder(const ExchangeRecorder&) = delete;
  ExchangeRecorder& operator=(const ExchangeRecorder&) = delete;
  ~ExchangeRecorder();  ///< ends the recording, if nobody did

  /// Start-up only. False with one line when the file cannot be made. `map` must outlive this
  /// object; `head` is what the first line says. Beyond `bytes_max` nothing more is recorded, and
  /// the journal says so.
  bool start(const char* path, const RecordingHead& head, const RegisterMap& map,
             const ScaledClock& clock, FileMessage& error,
             std::int64_t bytes_max = kRecordingBytesMax);
  /// For the link, whose thread then calls nothing here that waits or allocates.
  [[nodiscard]] ExchangeListener listener();
  /// Writes what is still queued and the last line, and gives the file its name. False with one
  /// line.
  bool finish(FileMessage& error);

  [[nodiscard]] std::int64_t exchanges() const { return written_; }
  [[nodiscard]] std::int64_t dropped() const { return dropped_; }

 private:
  static constexpr std::size_t kQueueLength = 128;  // a cycle makes some twenty

  void push(BusExchange exchange);
  void run();
  void keep(BusExchange& exchange);
  bool write_line(const char* line, std::size_t size);
  void stop_writing(const char* why);
  bool write_end();

  FixedText<511> path_;
  FixedText<519> part_path_;
  ScaledClock clock_;
  std::optional<RecordingMask> mask_;
  HandoverQueue<BusExchange, kQueueLength> queue_;
  std::atomic<std::int64_t> written_{0};
  std::atomic<std::int64_t> dropped_{0};
  std::atomic<bool> ending_{false};
  std::int64_t bytes_ = 0;
  std::int64_t bytes_max_ = 0;
  bool is_writing_ = false;
  bool has_failed_ = false;
  int fd_ = -1;
  PlainThread thread_;
};

}  // namespace bess
