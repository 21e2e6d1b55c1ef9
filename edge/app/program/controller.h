// Controller, a template over its world: the machine of bess-edge (real_world.h), or virtual time
// and memory (tools/hil_runner/virtual/virtual_world.h), so that tests run the production code.
//   reach   find and identify the battery
//   begin   first price, restored state, price level, operator files
//   run     control cycles, each logged and published; then hand over, or 0 W and release
// After `begin` nothing here allocates.
//
//   World        types Prices, Limits and Seal: control_loop.h, site_limits.h. While a Seal exists,
//                nothing may allocate
//     devices    EdgeClock& clock(), ModbusBattery& battery(), Prices& prices(),
//                ModbusMeter& meter(), Limits& limits()
//     prices     Status check_price_server(), the first answer; PublishedHistory find_history(),
//                the price level of the last hours; OutlookExchange* await_outlook(level_centi),
//                plans for a student by outlook, from this level; null for other contexts
//     state      bool open(); RestoredState restore_state(); both report their own errors. bool
//                read_back(number, CycleRecord&) const, 0: the newest; keep(record)
//     operator   const LatestHold& listen(); bool is_cleared(trip_utc_s)
//     observers  needs_time(seconds), complain(level, line), write_line(level, line), begins(),
//                is_ready(), cycle_done(record), stops(),
//                has_stopped(record, is_in_control, ends_by_itself)
#pragma once

#include <cstdint>
#include <string>

#include "edge/app/program/find_battery.h"
#include "edge/app/program/restored_run.h"
#include "edge/app/program/startup.h"
#include "edge/app/storage/commission_file.h"
#include "edge/app/storage/restored_state.h"
#include "edge/core/loop/control_loop.h"
#include "edge/prices/record/transport_security.h"
#include "edge/records/log/journal.h"

namespace bess {

template <typename World>
class Controller {
 public:
  using Site = SiteLimits<ModbusMeter, typename World::Limits>;
  using Loop = ControlLoop<ModbusBattery, typename World::Prices, EdgeClock, Site>;

  /// Both must outlive this object.
  Controller(const EdgeConfig& config, World& world)
      : config_(config),
        world_(world),
        loop_(config.control, world.battery(), world.prices(), world.clock(),
              Site(config.site.settings, &world.meter(), &world.limits())) {}

  /// True if the battery is found.
  bool reach() {
    world_.needs_time(config_.battery.start_timeout_s + kStartMarginS);
    for (const std::int8_t point : commissioned_points(config_)) world_.battery().require(point);
    const BatterySearch found = find_battery(config_, world_.battery(), world_.clock());
    if (found.status == Status::kOk) return true;
    world_.complain(JournalLevel::kError, "battery at " + found.trouble);
    return false;
  }

  /// False if this run must not control, or cannot store its log.
  bool begin() {
    if (!world_.open()) return false;
    const Status price_server_status = await_price_server();
    world_.begins();
    take_over(price_server_status);
    loop_.follow_holds(world_.listen());
    world_.is_ready();
    return true;
  }

  /// Runs until a stop request or `cycles` control cycles (negative: no limit); the last order
  /// keeps its full step. False if the battery was not released.
  bool run(std::int64_t cycles) {
    CycleRecord record{};
    const typename World::Seal seal;  // from here on this thread calls no allocator
    world_.clock().wait_for_simulated_start();
    for (std::int64_t i = 0; i != cycles && loop_.run_cycle(record); ++i) {
      world_.keep(record);
      world_.cycle_done(record);
      if (loop_.trip() && world_.is_cleared(loop_.trip()->utc_s)) loop_.clear_trip();
    }
    return end(record);
  }

 private:
  static constexpr std::int64_t kStartMarginS = 60;  ///< for the other waits of the start

  bool end(CycleRecord& record) {
    loop_.finish_step();
    world_.stops();
    if (!world_.clock().hand_over_requested() || !loop_.hand_over(record)) loop_.stop(record);
    world_.keep(record);
    world_.has_stopped(record, loop_.is_in_control(), loop_.order_ends_by_itself());
    return record.battery_status == Status::kOk;
  }

  /// Reports a missing first price.
  Status await_price_server() {
    const Status status = world_.check_price_server();
    if (status == Status::kOk) return status;
    world_.complain(JournalLevel::kWarning,
                    "note: no price yet from " +
                        std::string(loggable_url(config_.price.feed.http.url.view()).view()) +
                        ": " + std::string(price_status_text(status)) + "; 0 W until one arrives");
    return status;
  }

  void take_over(Status price_server_status) {
    const bool needs_level = student_context().kind != ContextKind::kMonth;
    if (needs_level) world_.needs_time(kHistoryWait_s + kStartMarginS);
    const RestoredState restored = world_.restore_state();
    const BatteryCounters& counters = restored.before.counters;
    world_.battery().restore_flash_writes(counters.flash_day, counters.flash_writes_today);
    const LevelStartReport level_report =
        starting_level(config_, restored.before.price_level, price_server_status, world_);
    if (needs_level)
      world_.write_line(journal_level_of(level_report), level_start_text(level_report));
    recall_cycles(world_, utc_seconds(world_.clock()), loop_);
    loop_.take_over(take_over_of(restored.before, level_report.start.level), restored.trip);
    loop_.follow_outlook(world_.await_outlook(level_report.start.level.centi_eur_per_mwh()));
  }

  const EdgeConfig& config_;
  World& world_;
  Loop loop_;
};

}  // namespace bess
