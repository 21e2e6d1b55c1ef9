// Event log of the controller. The control thread passes one record per control cycle and never
// waits; the log thread, on a static stack, writes it:
//   CycleRecord -> queue -> log thread -> run folder (memory): short ring, metrics, status
//                                      -> stdout (journal), ring log, CSV, metrics, status
// The run folder comes first, because it survives a disk failure. A disk may block: the queue holds
// 64 records (two hours); further records are dropped and counted. After `open` neither thread
// allocates here.
#pragma once

#include <atomic>
#include <cstdint>

#include "edge/core/control/control_types.h"
#include "edge/records/log/atomic_file.h"
#include "edge/records/log/handover_queue.h"
#include "edge/records/log/ring_log.h"
#include "edge/records/log/run_status.h"
#include "edge/records/log/text_buffer.h"
#include "shared/fixed_text.h"

namespace bess {

/// Journal lines on changes of hold, meter and battery readings, written by the log thread without
/// allocation. Each function appends the line of this control cycle; false without one.
class ChangeLines {
 public:
  /// When a hold begins, changes or ends, and once when its file is unreadable.
  bool add_hold_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);
  // At begin and end: meter mismatch, implausible house load, a reading missing or out of range.
  bool add_trust_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);
  bool add_house_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);
  bool add_lost_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);
  bool add_cut_line(const CycleRecord& record, const RunIdentity& identity, TextBuffer& line);

 private:
  HoldReport hold_{};
  bool was_mismatch_ = false;
  bool was_implausible_ = false;
  std::int16_t lost_ = 0;
  std::int16_t cut_ = 0;
};

struct EventLogSettings {
  FixedText<511> ring;
  FixedText<511> status;
  FixedText<511> metrics;
  FixedText<511> csv;  ///< empty = none
  // In the run folder, on a memory file system; all empty = none.
  FixedText<511> run_ring;
  FixedText<511> run_status;
  FixedText<511> run_metrics;
  std::int64_t ring_days = 35;  ///< of 720 records
};

class EventLog {
 public:
  EventLog() = default;
  EventLog(const EventLog&) = delete;
  EventLog& operator=(const EventLog&) = delete;
  ~EventLog();

  /// Opens the files, publishes a first status and starts the log thread. False with one line. A
  /// full, read-only or broken disk is reported and retried with every record.
  bool open(const EventLogSettings& settings, const RunIdentity& identity, FileMessage& error);
  /// Newest record of earlier runs, for counters that survive a restart; false = none. Only before
  /// the first `write`.
  bool newest(CycleRecord& record) const { return newer_ring().newest(record); }
  /// The record `records` before the newest; false = none, or torn. As `newest`.
  bool read_back(std::int64_t records, CycleRecord& record) const {
    const std::uint64_t newest = newer_ring().newest_number();
    const auto back = static_cast<std::uint64_t>(records);
    return back < newest &&
           (ring_.read(newest - back, record) || run_ring_.read(newest - back, record));
  }
  /// The two rings. Only before the first `write`.
  [[nodiscard]] const RingLog& ring() const { return ring_; }
  [[nodiscard]] const RingLog& run_ring() const { return run_ring_; }

  /// Called by the control thread; never waits.
  void write(const CycleRecord& record);
  /// Waits at most `wall_ns_max` until all records are written, at the end of the process.
  bool drain(std::int64_t wall_ns_max) const;

 private:
  static constexpr std::size_t kQueueRecords = 64;

  bool open_ring(FileMessage& error);
  void open_run_ring();
  void report_damage(const RingLog& ring, const char* path) const;
  [[nodiscard]] const RingLog& newer_ring() const {
    return run_ring_.newest_number() > ring_.newest_number() ? run_ring_ : ring_;
  }
  bool open_csv(FileMessage& error);
  bool head_csv();
  void take(const CycleRecord& record);
  void keep(const CycleRecord& record);
  void report_trip(const CycleRecord& record);
  void keep_in_memory(const CycleRecord& record, std::uint64_t number);
  void keep_on_disk(const CycleRecord& record, std::uint64_t number);
  bool append_to_run_ring(const CycleRecord& record, std::uint64_t number);
  bool append_to_ring(const CycleRecord& record, std::uint64_t number);
  bool follow_the_folder();
  bool catch_up(std::uint64_t number);
  bool append_to_csv(const CycleRecord& record);
  void publish_in_memory();
  [[nodiscard]] bool publish_metrics(const char* path);
  [[nodiscard]] bool publish_status(const FixedText<511>& path);
  void report_disk(bool is_failing, const CycleRecord* record);
  void add_present_state(const CycleRecord* record, TextBuffer& line) const;
  void report_run_folder();
  void report_changes(const CycleRecord& record);

  EventLogSettings settings_;
  StoredStatus stored_;
  const RunIdentity& identity_ = stored_.status.identity;
  RunTotals& totals_ = stored_.status.totals;
  RingLog ring_;
  RingLog run_ring_;
  int csv_fd_ = -1;
  bool was_tripped_ = false;
  bool csv_has_head_ = false;
  bool was_failing_ = false;
  bool was_run_failing_ = false;
  bool is_ending_run_ = false;
  ChangeLines change_lines_;
  HandoverQueue<CycleRecord, kQueueRecords> queue_;
  std::int64_t handed_over_ = 0;
  std::atomic<std::int64_t> kept_{0};
  std::atomic<std::int64_t> dropped_{0};
  char status_text_[kStatusBytes];
  char metrics_text_[kMetricsBytes];
};

}  // namespace bess
