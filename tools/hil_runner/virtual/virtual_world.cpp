#include "tools/hil_runner/virtual/virtual_world.h"

#include <iterator>
#include <memory>

#include "edge/fetch/history_pages.h"
#include "edge/log/record_codec.h"
#include "shared/host/user_error.h"
#include "shared/scaled_clock.h"

namespace bess {
void EdgeState::add(const CycleRecord& record) {
  RecordBytes bytes{};
  encode_record(record, records_.size() + 1, bytes);
  std::uint64_t number = 0;
  if (!decode_record(bytes, records_.emplace_back(), number))
    fail("a record of the edge's ring cannot be read");
}

bool EdgeState::read_back(std::int64_t records, CycleRecord& record) const {
  const auto size = std::ssize(records_) - readable_from_;
  if (records >= size) return false;
  record = records_[records_.size() - 1 - static_cast<std::size_t>(records)];
  return true;
}

Trip EdgeState::trip() const {
  return !records_.empty() && !is_lost() && records_.back().is_tripped ? records_.back().trip
                                                                       : Trip{};
}

VirtualWorld::VirtualWorld(const EdgeConfig& config, const VirtualPrices& prices,
                           const Surroundings& around)
    : around_(around),
      price_(config.price),
      clock_(config.clock),
      battery_(config.battery.link, config.battery.map, config.clock),
      meter_(config.site.link, config.site.map, config.clock),
      prices_(prices) {}

Recall VirtualWorld::recall() const {
  Recall recalled;
  static_cast<void>(around_.state.read_back(0, recalled.before));
  const Trip trip = around_.state.trip();
  if (trip.is_set() && !around_.people.is_cleared(trip.utc_s)) recalled.trip = trip;
  if (!around_.state.is_lost()) return recalled;
  recalled.unknown = "the scenario's disk has lost it";
  recalled.trip = trip_without_state(recalled, around_.time.edge_utc_ns() / kNanosecondsPerSecond);
  return recalled;
}

PublishedHistory VirtualWorld::find_history() {
  const auto history = std::make_unique<PriceHistory>(
      price_.history.hours, around_.time.edge_utc_ns() / kNanosecondsPerSecond);
  const Status status = fetch_history(prices_, price_.feed, price_.history, clock_, *history);
  return {.is_done = true,
          .hours = history->hours_covered(),
          .rows = history->rows(),
          .status = status,
          .level = history->level()};
}

void VirtualWorld::cycle_done(const CycleRecord&) {
  if (around_.weather == nullptr) return;
  const std::int64_t now_utc_s = around_.time.utc_ns() / kNanosecondsPerSecond;
  around_.physics.set_derating(around_.weather(now_utc_s));
}

}  // namespace bess
