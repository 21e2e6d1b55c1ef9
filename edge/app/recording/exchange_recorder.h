// Exchange recorder: writes Modbus traffic to a recording (shared/host/bus_recording.h). The link's
// thread puts each exchange into a fixed-size queue; another thread, on a static stack, masks
// private data and writes, so that no disk delays an order. Excess exchanges are dropped and
// counted. Writes FILE.part and renames it at the end; a killed process leaves FILE.part with
// complete lines.
#pragma once

#include <atomic>
#include <cstdint>
#include <optional>
#include <string_view>

#include "edge/app/recording/recording_mask.h"
#include "edge/device/battery/modbus_link.h"
#include "edge/records/log/atomic_file.h"
#include "edge/records/log/handover_queue.h"
#include "shared/host/bus_recording.h"
#include "shared/scaled_clock.h"

namespace bess {

/// Head of a recording of this battery.
RecordingHead recording_head_of(const RegisterMap& map, const BatteryLinkSettings& link,
                                const ScaledClock& clock);

inline constexpr std::int64_t kRecordingBytesMax = 256 << 20;  ///< three months or more

class ExchangeRecorder {
 public:
  ExchangeRecorder() = default;
  ExchangeRecorder(const ExchangeRecorder&) = delete;
  ExchangeRecorder& operator=(const ExchangeRecorder&) = delete;
  ~ExchangeRecorder();  ///< ends the recording, if still open

  /// Start-up only. False with one line if the file cannot be created. `map` must outlive this
  /// object; `head`: first line. Beyond `bytes_max` recording ends with a journal line.
  bool start(const char* path, const RecordingHead& head, const RegisterMap& map,
             const ScaledClock& clock, FileMessage& error,
             std::int64_t bytes_max = kRecordingBytesMax);
  /// Listener for the link; its calls do not wait or allocate.
  [[nodiscard]] ExchangeListener listener();
  /// Writes the queue and the last line, and renames the file. False with one line.
  bool finish(FileMessage& error);

  [[nodiscard]] std::int64_t exchanges() const { return written_; }

 private:
  static constexpr std::size_t kQueueLength = 128;  // about 20 per control cycle

  void push(BusExchange exchange);
  void keep(BusExchange& exchange);
  bool write_line(std::string_view line);
  void stop_writing(const char* why);
  bool write_end();

  FixedText<511> path_;
  FixedText<519> part_path_;
  ScaledClock clock_;
  std::optional<RecordingMask> mask_;
  HandoverQueue<BusExchange, kQueueLength> queue_;
  std::atomic<std::int64_t> written_{0};
  std::atomic<std::int64_t> dropped_{0};
  std::int64_t bytes_ = 0;
  std::int64_t bytes_max_ = 0;
  bool is_writing_ = false;
  bool has_failed_ = false;
  int fd_ = -1;
};

}  // namespace bess
