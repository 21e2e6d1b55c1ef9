#include "tools/hil_runner/virtual/virtual_world.h"

#include "shared/scaled_clock.h"

namespace bess {
namespace {

LoggedCycle logged(const CycleRecord& record) {
  const BatteryMeasurement& m = record.measurement;
  return {.utc_s = record.utc_s,
          .mode = record.mode,
          .has_measurement = record.has_measurement,
          .soc_e4 = m.soc_e4,
          .has_price = record.price.has_row,
          .price_minute_utc_s = record.price.minute_utc_s,
          .price_centi_eur_per_mwh = record.price.price_centi_eur_per_mwh,
          .has_student_action = record.has_student_action,
          .student_action = record.student_action,
          .context_class = record.context_class,
          .ordered_power_w = record.ordered_power_w,
          .battery_power_w = m.power_w,
          .reason = std::string(reason_name(record.reason)),
          .written = record.written};
}

}  // namespace

void EdgeState::add(const CycleRecord& record) {
  records_.push_back(record);
  if (records_.size() > kRecordsMax) records_.pop_front();
}

bool EdgeState::read_back(std::int64_t records, CycleRecord& record) const {
  const auto size = static_cast<std::int64_t>(records_.size());
  if (records >= size) return false;
  record = records_[static_cast<std::size_t>(size - 1 - records)];
  return true;
}

Trip EdgeState::trip() const {
  CycleRecord newest;
  return read_back(0, newest) && newest.is_tripped ? newest.trip : Trip{};
}

VirtualWorld::VirtualWorld(const EdgeConfig& config, const VirtualPrices& prices,
                           const Surroundings& around)
    : around_(around),
      clock_(config.clock, config.require_synchronised_clock),
      battery_(config.link, config.map, config.clock),
      meter_(config.site.link, config.site.map, config.clock),
      prices_(prices) {}

Recall VirtualWorld::recall() const {
  Recall recalled;
  static_cast<void>(around_.state.read_back(0, recalled.before));
  const Trip trip = around_.state.trip();
  if (trip.is_set() && !around_.people.is_cleared(trip.utc_s)) recalled.trip = trip;
  return recalled;
}

void VirtualWorld::keep(const CycleRecord& record) {
  around_.state.add(record);
  around_.evidence.log.push_back(logged(record));
}

void VirtualWorld::cycle_done(const CycleRecord&) {
  if (around_.weather == nullptr) return;
  const std::int64_t now_utc_s = around_.time.utc_ns() / kNanosecondsPerSecond;
  around_.physics.set_derating(around_.weather(now_utc_s));
}

}  // namespace bess
