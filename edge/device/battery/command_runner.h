// Command runner: writes, pauses and read-back of one map command. It remembers known register
// contents, so that flash is written only on changes, and counts the writes.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstdlib>

#include "edge/device/battery/battery_bus.h"
#include "edge/device/registers/battery_command.h"
#include "edge/device/registers/codec.h"

namespace bess {

// Flash budget: remaining writes of flash registers today. Flash endures some 100,000 writes: one
// every two minutes would wear it out within months.

class FlashBudget {
 public:
  explicit FlashBudget(const WritePolicy& policy) : policy_(policy) {}

  /// Writes of an earlier process on that day.
  void restore(std::int64_t day, std::int32_t writes) {
    day_ = day;
    writes_ = writes;
  }
  /// Orders keep the reserve: one release is always possible.
  [[nodiscard]] bool allows(std::int64_t day, std::int32_t writes) const {
    if (policy_.eeprom_writes_per_day == 0 || writes == 0) return true;
    const std::int32_t used = day == day_ ? writes_ : 0;
    return used + writes <= policy_.eeprom_writes_per_day - policy_.reserve;
  }
  /// The reserve is used up too: a device rejects releases that are retried every cycle.
  [[nodiscard]] bool is_spent(std::int64_t day) const {
    return policy_.eeprom_writes_per_day > 0 && writes_on(day) >= policy_.eeprom_writes_per_day;
  }
  void count(std::int64_t day) {
    if (day != day_) writes_ = 0;
    day_ = day;
    ++writes_;
  }
  [[nodiscard]] std::int32_t writes_on(std::int64_t day) const { return day == day_ ? writes_ : 0; }

 private:
  WritePolicy policy_;
  std::int64_t day_ = 0;
  std::int32_t writes_ = 0;
};

/// Register contents where an order was written.
enum class OrderTrace : std::uint8_t {
  kOurs,
  kAtRest,  ///< its end markers are as after a release, the rest is ours
  kForeign
};

template <typename Link, typename Time>
class CommandRunner {
 public:
  CommandRunner(const RegisterMap& map, BatteryBus<Link, Time>& bus)
      : map_(map), bus_(bus), budget_(map.writes) {}

  [[nodiscard]] FlashBudget& budget() { return budget_; }
  [[nodiscard]] const FlashBudget& budget() const { return budget_; }
  [[nodiscard]] PointValues& saved() { return saved_; }
  void forget() { written_.forget(); }

  /// kOk, or why the map, its live values or the flash budget do not permit this command.
  Status check(const CommandSequence& sequence, const PowerOrder& order) {
    int worn = 0;
    for (const BlockWrite& write : sequence.writes) {
      RegisterBlock block;
      Status status = encode(write, order, block);
      if (status != Status::kOk) return status;
      if (!write.eeprom) continue;
      bool same = false;
      status = is_in_device(write, block, same);
      if (status != Status::kOk) return status;
      worn += same ? 0 : 1;
    }
    return budget_.allows(bus_.time().utc_day(), worn) ? Status::kOk : Status::kWriteBudget;
  }

  /// True if the registers are known to hold the command's values, except its heartbeat.
  [[nodiscard]] bool is_written(const CommandSequence& sequence, const PowerOrder& order) {
    for (int i = 0; i < sequence.writes.size(); ++i) {
      RegisterBlock block;
      if (encode(sequence.writes[i], order, block) != Status::kOk) return false;
      int offset = 0;
      for (const WriteValue& value : sequence.writes[i].values) {
        const bool counts =
            value.argument != Argument::kHeartbeat && !is_written_later(sequence, i, value.point);
        if (counts && !holds(written_, value.point, block.data(), offset)) return false;
        offset += map_.points[value.point].registers;
      }
    }
    return true;
  }

  /// Register contents of a confirmed order. Values that the device counts itself, and unconfirmed
  /// ones, are no evidence.
  Status trace(Command command, OrderTrace& found) {
    found = OrderTrace::kOurs;
    StaticVector<std::int8_t, kPointsMax> points;
    for_each_of_order(command, [&](const BlockWrite&, int point) {
      points.push_back(static_cast<std::int8_t>(point));
    });
    if (points.empty()) return Status::kOk;
    PointValues now;
    const Status status = read_written(points, now);
    if (status != Status::kOk) return status;
    for_each_of_order(command, [&](const BlockWrite& write, int point) {
      if (is_close(write, point, written_.raw[point], 0, now)) return;
      const bool rests = shows_end(point) && is_as_released(point, now);
      found = std::max(found, rests ? OrderTrace::kAtRest : OrderTrace::kForeign);
    });
    return Status::kOk;
  }

  Status run(const CommandSequence& sequence, const PowerOrder& order, std::int64_t patience_ns) {
    if (sequence.writes.empty()) return Status::kOk;
    return retried(bus_.time(), patience_ns, [&] { return run_once(sequence, order); });
  }

  /// Reads from the device whether a condition holds.
  Status test(const Condition& condition, bool& holds_now) {
    PointValues now = bus_.live();
    PlacedPoints points;
    const std::int8_t point = condition.point;
    points.push_back(bus_.placed(point, map_.points[point].read_function));
    const Status status = bus_.read_placed(points, now);
    std::int64_t value = 0;
    holds_now =
        status == Status::kOk && live_value(map_, now, point, value) && condition.holds(value);
    return status;
  }

  /// Reads written registers by function 3 into `out`.
  Status read_written(const StaticVector<std::int8_t, kPointsMax>& list, PointValues& out) {
    PlacedPoints points;
    for (const std::int8_t point : list) points.push_back(bus_.placed(point, 3));
    return bus_.read_placed(points, out);
  }

 private:
  Status encode(const BlockWrite& write, const PowerOrder& order, RegisterBlock& block) const {
    return encode_block(map_, write, order, block,
                        {.live = &bus_.live(), .saved = &saved_, .heartbeat = heartbeat_});
  }

  Status run_once(const CommandSequence& sequence, const PowerOrder& order) {
    ++heartbeat_;
    Status withheld = Status::kOk;  // a blocked flash write does not block the others
    for (const BlockWrite& write : sequence.writes) {
      RegisterBlock block;
      Status status = encode(write, order, block);
      bool same = false;
      if (status == Status::kOk && write.eeprom) status = is_in_device(write, block, same);
      if (status != Status::kOk) return status;
      if (!same && write.eeprom && budget_.is_spent(bus_.time().utc_day())) {
        withheld = Status::kWriteBudget;
        continue;
      }
      if (!same) status = send(write, block, order.write_until_ns);
      if (status != Status::kOk) return status;
    }
    return withheld == Status::kOk ? read_back(sequence, order) : withheld;
  }

  Status send(const BlockWrite& write, const RegisterBlock& block, std::int64_t send_until_ns) {
    if (write.eeprom) budget_.count(bus_.time().utc_day());
    const Status status = bus_.write(write, block, send_until_ns);
    int offset = 0;
    for (const WriteValue& value : write.values) {
      // Unknown until read back, unless the map says that it cannot be.
      written_.known[value.point] = false;
      if (status == Status::kOk && write.read_back == ReadBack::kNone) {
        written_.keep(map_, value.point, block.data() + offset);
      }
      offset += map_.points[value.point].registers;
    }
    return status;
  }

  /// Flash is compared before it is written; unknown values are read first.
  Status is_in_device(const BlockWrite& write, const RegisterBlock& block, bool& same) {
    StaticVector<std::int8_t, kPointsMax> unknown;
    for (const WriteValue& value : write.values) {
      if (!written_.known[value.point]) unknown.push_back(value.point);
    }
    if (!unknown.empty()) {
      const Status status = read_written(unknown, written_);
      if (status != Status::kOk) return status;
    }
    same = true;
    int offset = 0;
    for (const WriteValue& value : write.values) {
      same = same && holds(written_, value.point, block.data(), offset);
      offset += map_.points[value.point].registers;
    }
    return Status::kOk;
  }

  bool holds(const PointValues& registers, int point, const std::uint16_t* block,
             int offset) const {
    if (!registers.known[point]) return false;
    const int count = map_.points[point].registers;
    return std::equal(registers.raw[point], registers.raw[point] + count, block + offset);
  }

  static bool is_written_later(const CommandSequence& sequence, int write, int point) {
    for (int i = write + 1; i < sequence.writes.size(); ++i) {
      for (const WriteValue& value : sequence.writes[i].values) {
        if (value.point == point) return true;
      }
    }
    return false;
  }

  /// Calls `visit(write, value)` for the last written, readable value of each point of the
  /// sequence.
  template <typename Visit>
  static void for_each_read_back(const CommandSequence& sequence, const Visit& visit) {
    for (int i = 0; i < sequence.writes.size(); ++i) {
      if (sequence.writes[i].read_back == ReadBack::kNone) continue;
      for (const WriteValue& value : sequence.writes[i].values) {
        if (!is_written_later(sequence, i, value.point)) visit(sequence.writes[i], value);
      }
    }
  }

  /// Calls `visit(write, point)` for known registers of an order and of its enable command.
  template <typename Visit>
  void for_each_of_order(Command command, const Visit& visit) {
    const auto visit_known = [&](const BlockWrite& write, const WriteValue& value) {
      const bool counts = value.argument != Argument::kHeartbeat && written_.known[value.point] &&
                          value.point != map_.watchdog.remaining;
      if (counts) visit(write, value.point);
    };
    const CommandSequence& sequence = map_.sequence(command);
    for_each_read_back(sequence, visit_known);
    for_each_read_back(map_.sequence(Command::kEnable),
                       [&](const BlockWrite& write, const WriteValue& value) {
                         if (!is_written_later(sequence, -1, value.point))
                           visit_known(write, value);
                       });
  }

  /// True for points that a device writes when it ends an order by itself.
  [[nodiscard]] bool shows_end(int point) const {
    const auto is_this = [point](const auto& shown) { return shown.point == point; };
    return std::ranges::any_of(map_.active, is_this) ||
           std::ranges::any_of(map_.simulator.at_expiry, is_this);
  }

  [[nodiscard]] bool is_as_released(int point, const PointValues& now) const {
    for (const BlockWrite& write : map_.sequence(Command::kRelease).writes) {
      RegisterBlock block;
      if (encode(write, PowerOrder{}, block) != Status::kOk) continue;
      int offset = 0;
      for (const WriteValue& value : write.values) {
        if (value.point == point && holds(now, point, block.data(), offset)) return true;
        offset += map_.points[value.point].registers;
      }
    }
    return false;
  }

  /// Compares all values of the sequence in as few reads as possible.
  Status read_back(const CommandSequence& sequence, const PowerOrder& order) {
    StaticVector<std::int8_t, kPointsMax> wanted;
    for_each_read_back(sequence, [&](const BlockWrite&, const WriteValue& value) {
      wanted.push_back(value.point);
    });
    if (wanted.empty()) return Status::kOk;
    PointValues now;
    Status status = read_written(wanted, now);
    for (int i = 0; i < sequence.writes.size() && status == Status::kOk; ++i) {
      status = compare(sequence, i, order, now);
    }
    return status;
  }

  Status compare(const CommandSequence& sequence, int index, const PowerOrder& order,
                 const PointValues& now) {
    const BlockWrite& write = sequence.writes[index];
    RegisterBlock block;
    if (write.read_back == ReadBack::kNone) return Status::kOk;
    if (const Status status = encode(write, order, block); status != Status::kOk) return status;
    int offset = 0;
    for (const WriteValue& value : write.values) {
      const bool last = !is_written_later(sequence, index, value.point);
      if (last && !is_close(write, value.point, block.data(), offset, now)) {
        return Status::kNotApplied;
      }
      if (last) written_.keep(map_, value.point, block.data() + offset);
      offset += map_.points[value.point].registers;
    }
    return Status::kOk;
  }

  bool is_close(const BlockWrite& write, int point, const std::uint16_t* wanted_raw, int offset,
                const PointValues& now) const {
    if (holds(now, point, wanted_raw, offset)) return true;
    Scaling scaling;
    std::int64_t wanted = 0;
    std::int64_t got = 0;
    const bool is_open = map_.points[point].raw_at_max != 0;  // some devices clamp it
    if ((write.read_back != ReadBack::kTolerance && !is_open) || !now.known[point] ||
        !live_scaling(map_, bus_.live(), point, scaling)) {
      return false;
    }
    return decode(map_.points[point], wanted_raw + offset, wanted, scaling) &&
           decode(map_.points[point], now.raw[point], got, scaling) &&
           std::abs(wanted - got) <= write.tolerance;
  }

  const RegisterMap& map_;
  BatteryBus<Link, Time>& bus_;
  FlashBudget budget_;
  PointValues written_;  ///< confirmed by read-back, or written where it is not possible
  PointValues saved_;    ///< registers as they were before the first order
  std::int64_t heartbeat_ = 0;
};

}  // namespace bess
