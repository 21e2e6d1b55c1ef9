// Virtual world of a controller (edge/app/program/controller.h): the edge's clock, driver, link and
// meter on virtual buses, answers of the simulated market, and persistent state in EdgeState.
#pragma once

#include <cstdint>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "edge/app/program/controller.h"
#include "edge/app/settings/edge_config.h"
#include "edge/app/storage/restored_state.h"
#include "edge/core/control/hold.h"
#include "edge/core/site/connection_guard.h"
#include "edge/device/battery/modbus_battery.h"
#include "edge/records/log/journal.h"
#include "shared/host/minute_file.h"
#include "tools/hil_runner/evidence/evidence.h"
#include "tools/hil_runner/scenario/scenario.h"
#include "tools/hil_runner/virtual/virtual_prices.h"

namespace bess {

// Inputs from operators and other programs in a virtual run: hold, limits, and cleared trips. They
// persist over restarts, as files do; the edge's own code formats and reads them.

class VirtualOperator {
 public:
  /// `now_utc_s` by the edge's clock; `trip` is the one in force, if any.
  void act(const ScenarioEvent& event, std::int64_t now_utc_s, const std::optional<Trip>& trip);

  [[nodiscard]] const LatestHold& holds() const { return holds_; }
  [[nodiscard]] bool is_cleared(std::int64_t trip_utc_s) const { return cleared_.has(trip_utc_s); }
  /// Limit in the limit file.
  Status read(OutsideLimit& limit, bool& is_set) const;

 private:
  LatestHold holds_;
  ClearedTrips cleared_;
  std::string limit_;  ///< text of the file; empty: no file
};

// Scenario in virtual time: the edge's own loop, driver, link and guard with simulated battery and
// market, at the speed of the machine; byte-identical for every run.

/// Share of the battery's power available at an instant, by temperature; null: all.
using PowerDerating = double (*)(std::int64_t utc_s);

Evidence run_virtual(const Scenario& scenario, const MinuteSeries& prices, const EdgeConfig& config,
                     PowerDerating derating = nullptr);

/// Persistent state of bess-edge: its ring.
class EdgeState {
 public:
  /// Stores the encoded record: data without a field is lost.
  void add(const CycleRecord& record);
  [[nodiscard]] bool read_back(std::int64_t records, CycleRecord& record) const;
  /// Trip of the newest record.
  [[nodiscard]] std::optional<Trip> trip() const;
  /// Loses the state: records remain as evidence, but cannot be read back.
  void lose() { readable_from_ = std::ssize(records_); }
  /// State exists but is unreadable.
  [[nodiscard]] bool is_lost() const {
    return readable_from_ > 0 && readable_from_ == std::ssize(records_);
  }
  [[nodiscard]] const std::vector<CycleRecord>& records() const { return records_; }
  void reserve(std::size_t records) { records_.reserve(records); }
  [[nodiscard]] std::vector<CycleRecord> take_records() { return std::move(records_); }

 private:
  std::vector<CycleRecord> records_;
  std::ptrdiff_t readable_from_ = 0;
};

class VirtualWorld {
 public:
  using Prices = VirtualPrices;
  using Limits = VirtualOperator;
  /// No seal: records are stored in memory.
  struct Seal {
    Seal() {}
  };

  /// Parts that continue without the edge. All must outlive this object.
  struct VirtualEnvironment {
    VirtualTime& time;
    SimulatedBattery& physics;
    PowerDerating derating;
    EdgeState& state;
    VirtualOperator& site_operator;
    VirtualOutlook* outlook = nullptr;  ///< null unless the student's context is the outlook
  };
  VirtualWorld(const EdgeConfig& config, const VirtualPrices& prices,
               const VirtualEnvironment& environment);

  EdgeClock& clock() { return clock_; }
  ModbusBattery& battery() { return battery_; }
  VirtualPrices& prices() { return prices_; }
  ModbusMeter& meter() { return meter_; }
  VirtualOperator& limits() { return environment_.site_operator; }

  static bool open() { return true; }
  [[nodiscard]] RestoredState restore_state() const;
  bool read_back(std::int64_t records, CycleRecord& record) const {
    return environment_.state.read_back(records, record);
  }
  void keep(const CycleRecord& record) {
    environment_.state.add(record);
    if (environment_.outlook != nullptr) environment_.outlook->cycle_done(record);
  }
  Status check_price_server() {
    PriceRow row;
    return prices_.fetch_once(row);
  }
  PublishedHistory find_history();
  const LatestHold& listen() { return environment_.site_operator.holds(); }
  OutlookExchange* await_outlook(std::int32_t level_centi) {
    return environment_.outlook == nullptr ? nullptr : environment_.outlook->start(level_centi);
  }
  [[nodiscard]] bool is_cleared(std::int64_t trip_utc_s) const {
    return environment_.site_operator.is_cleared(trip_utc_s);
  }

  static void needs_time(std::int64_t) {}
  static void complain(JournalLevel, const std::string&) {}
  static void write_line(JournalLevel, const std::string&) {}
  static void begins() {}
  static void is_ready() {}
  void cycle_done(const CycleRecord& record);
  static void stops() {}
  static void has_stopped(const CycleRecord&, bool, bool) {}

 private:
  VirtualEnvironment environment_;
  const PriceConfig& price_;
  EdgeClock clock_;
  ModbusBattery battery_;
  ModbusMeter meter_;
  VirtualPrices prices_;
};

}  // namespace bess
