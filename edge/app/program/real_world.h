// Real world of the controller (controller.h): Modbus battery and meter, prices, decision log on
// disk, operator files, journal and systemd.
#pragma once

#include <string>

#include "edge/app/program/edge_clock.h"
#include "edge/app/program/hold_watch.h"
#include "edge/app/program/service_notify.h"
#include "edge/app/recording/exchange_recorder.h"
#include "edge/app/settings/edge_config.h"
#include "edge/app/storage/operator_files.h"
#include "edge/app/storage/restored_state.h"
#include "edge/core/memory/heap_seal.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/prices/record/price_reader.h"
#include "edge/records/log/event_log.h"
#include "edge/records/log/journal.h"

namespace bess {

class RealWorld {
 public:
  using Prices = PriceReader;
  using Limits = LimitFile;
  using Seal = HeapSeal;

  /// Devices shared with other commands. They and the configuration must outlive this object.
  struct Devices {
    EdgeClock& clock;
    ModbusBattery& battery;
    ModbusMeter& meter;
    PriceReader& prices;
  };
  RealWorld(const EdgeConfig& config, const Devices& devices);

  EdgeClock& clock() { return devices_.clock; }
  ModbusBattery& battery() { return devices_.battery; }
  PriceReader& prices() { return devices_.prices; }
  ModbusMeter& meter() { return devices_.meter; }
  LimitFile& limits() { return limits_; }

  /// Starts recording the battery's Modbus traffic; an empty path records nothing. False with one
  /// line.
  bool record_battery(const std::string& path, FileMessage& error);
  bool finish_recording(FileMessage& error) { return recorder_.finish(error); }

  /// Checks the commissioning, then opens the log, so that a refused run keeps the previous status.
  bool open();
  /// State of earlier runs. If it is unreadable, a journal line has the cause, and there is no
  /// control until a person clears it.
  RestoredState restore_state();
  bool read_back(std::int64_t records, CycleRecord& record) const {
    return log_.read_back(records, record);
  }
  void keep(const CycleRecord& record) { log_.write(record); }

  Status check_price_server();
  PublishedHistory find_history();
  const LatestHold& listen();
  OutlookExchange* await_outlook(std::int32_t level_centi);
  bool is_cleared(std::int64_t trip_utc_s) { return hold_watch_.is_cleared(trip_utc_s); }

  void needs_time(std::int64_t seconds) { notify_.extend_start(seconds); }
  static void complain(JournalLevel level, const std::string& line);
  static void write_line(JournalLevel level, const std::string& line) {
    write_journal_line(level, line);
  }
  /// Logs the start. From now on a failed internal check releases the battery.
  void begins();
  void is_ready() { notify_.ready(); }
  void cycle_done(const CycleRecord& record) { notify_.cycle_done(record); }
  void stops() { notify_.stopping(); }
  void has_stopped(const CycleRecord& last, bool is_in_control, bool ends_by_itself);

 private:
  const EdgeConfig& config_;
  Devices devices_;
  ServiceNotify notify_;
  EventLog log_;
  ExchangeRecorder recorder_;
  LimitFile limits_;
  HoldWatch hold_watch_;
  std::uint64_t published_ = 0;  ///< newest record number in a status at the start
};

}  // namespace bess
