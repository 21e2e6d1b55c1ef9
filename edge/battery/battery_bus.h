// A register map's points over a link: where they lie (unit groups, SunSpec models), reading those
// whose values are too old, doing without those that this device does not have, writing blocks,
// telling which errors deserve a retry. A template over link and time, so that the same code drives
// Modbus, and registers in memory in the tests.
//
//   Link   Status read(const RegisterSpan&, uint16_t*); Status write(unit, function, address,
//          const uint16_t*, count, send_until_ns); void close(); int last_exception() const
//   Time   int64 now_ns(); void sleep_ms(int); int64 utc_day()
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>

#include "edge/base/status.h"
#include "edge/battery/read_plan.h"
#include "edge/registers/live_points.h"
#include "shared/scaled_clock.h"

namespace bess {

inline constexpr int kBusAttempts = 2;  // a dropped connection is mended once within the cycle

/// False for answers that the same question would get again.
constexpr bool is_worth_a_retry(Status status) {
  return status == Status::kNotConnected || status == Status::kTimeout ||
         status == Status::kBusBusy || status == Status::kBadReply || status == Status::kNotApplied;
}

template <typename Request>
Status retried(Request request) {
  Status status = Status::kOk;
  for (int attempt = 0; attempt < kBusAttempts; ++attempt) {
    status = request();
    if (!is_worth_a_retry(status)) break;
  }
  return status;
}

template <typename Link, typename Time>
class BatteryBus {
 public:
  /// `unit` replaces the map's unit id when it is not negative. `map` must outlive this object.
  template <typename... LinkArguments>
  BatteryBus(const RegisterMap& map, const Time& time, std::int32_t unit, LinkArguments&&... link)
      : map_(map),
        time_(time),
        unit_(unit >= 0 ? unit : map.unit),
        link_(std::forward<LinkArguments>(link)...) {}

  [[nodiscard]] const LivePoints& live() const { return live_; }
  [[nodiscard]] const Time& time() const { return time_; }
  [[nodiscard]] Link& link() { return link_; }
  [[nodiscard]] const Link& link() const { return link_; }
  [[nodiscard]] std::int64_t last_read_ns() const { return last_read_ns_; }

  /// Finds the models that the map's points refer to. kImplausible: not such a device. What was
  /// found missing is asked for again: the device may be another one, or was not ready yet.
  Status locate_models() {
    missing_.clear();
    if (map_.models.empty()) return Status::kOk;
    for (const std::uint16_t base : map_.model_bases) {
      bool found = false;
      const Status status = walk_models(base, found);
      if (found) return status;
      const bool elsewhere = status == Status::kBusException || status == Status::kImplausible;
      if (!elsewhere) return status;
    }
    return Status::kImplausible;
  }

  /// Reads every measured point whose value is older than the map allows.
  Status read_due() {
    PlacedPoints due;
    for (const std::int8_t point : map_.measure) {
      if (!is_fresh(point) && !is_missing(point))
        due.push_back(placed(point, map_.points[point].read_function));
    }
    const Status status = read_placed(due, live_);
    if (status == Status::kOk) last_read_ns_ = time_.now_ns();
    return status;
  }

  /// Reads `points` into `out`; optional ones that turn out to be missing leave the list.
  Status read_placed(PlacedPoints& points, LivePoints& out) {
    while (true) {  // every round but the last finds one that is missing
      ReadPlan plan;
      RegisterSpan refused;
      plan_reads(map_, points, missing_, plan);
      const Status status = read_planned(plan, points, out, refused);
      if (status == Status::kOk || !find_missing(refused, points)) return status;
    }
  }

  /// `function` 3 for what was written, whatever table the point is measured from.
  [[nodiscard]] PlacedPoint placed(std::int8_t point, std::uint8_t function) const {
    const RegisterPoint& p = map_.points[point];
    const int start = p.model < 0 ? 0 : model_start_[p.model];
    return {.place = {.unit = p.unit_group < 0 ? unit_ : map_.unit_of(p),
                      .address = static_cast<std::uint16_t>(start + p.address),
                      .count = p.registers,
                      .function = function},
            .point = point};
  }

  Status read_point(std::int8_t point, std::uint16_t* registers) {
    return read_span(placed(point, map_.points[point].read_function).place, registers);
  }

  /// Not after `send_until_ns`, CLOCK_MONOTONIC.
  Status write(const BlockWrite& write, const RegisterBlock& block, std::int64_t send_until_ns) {
    const PlacedPoint first = placed(write.values[0].point, 3);
    return judged(link_.write(first.place.unit, write.function, first.place.address, block.data(),
                              block.size(), send_until_ns));
  }

 private:
  /// `failed` is the span at which it ended.
  Status read_planned(const ReadPlan& plan, const PlacedPoints& points, LivePoints& out,
                      RegisterSpan& failed) {
    for (const RegisterSpan& span : plan) {
      std::uint16_t registers[kSpanRegistersMax] = {};
      failed = span;
      const Status status = read_span(span, registers);
      if (status != Status::kOk) return status;
      for (const PlacedPoint& point : points) {
        const int offset = offset_in(span, point);
        if (offset < 0) continue;
        out.keep(map_, point.point, registers + offset);
        if (&out == &live_) read_ns_[point.point] = time_.now_ns();
      }
    }
    return Status::kOk;
  }

  /// An optional point may be why the device refused a span: they are asked for one by one, and
  /// what is refused again leaves `points`. False when nothing does.
  bool find_missing(const RegisterSpan& refused, PlacedPoints& points) {
    if (!has_no_such_register()) return false;
    PlacedPoints kept;
    for (const PlacedPoint& point : points) {
      std::uint16_t registers[kTextRegistersMax] = {};
      const bool is_suspect = map_.points[point.point].optional && offset_in(refused, point) >= 0;
      const bool is_there = !is_suspect || read_span(point.place, registers) == Status::kOk ||
                            !has_no_such_register();
      if (!is_there) live_.known[point.point] = false;
      (is_there ? kept : missing_).push_back(point);
    }
    const bool found = kept.size() < points.size();
    points = kept;
    return found;
  }

  /// By the last answer: an illegal address; behind a gateway, a device that is not there.
  [[nodiscard]] bool has_no_such_register() const {
    constexpr int kIllegalDataAddress = 2;
    constexpr int kGatewayPathUnavailable = 10;
    constexpr int kGatewayTargetSilent = 11;
    const int code = link_.last_exception();
    return code == kIllegalDataAddress || code == kGatewayPathUnavailable ||
           code == kGatewayTargetSilent;
  }

  [[nodiscard]] bool is_missing(std::int8_t point) const {
    return std::any_of(missing_.begin(), missing_.end(),
                       [point](const PlacedPoint& m) { return m.point == point; });
  }

  bool is_fresh(std::int8_t point) const {
    const std::int64_t age_ns = time_.now_ns() - read_ns_[point];
    return live_.known[point] && age_ns < map_.points[point].max_age_s * kNanosecondsPerSecond;
  }

  Status read_span(const RegisterSpan& span, std::uint16_t* registers) {
    return judged(link_.read(span, registers));
  }

  /// What an exception code means, by the map's lists.
  Status judged(Status status) const {
    const int code = link_.last_exception();
    if (status == Status::kOk || code == 0) return status;
    const auto listed = [code](const auto& codes) {
      return std::find(codes.begin(), codes.end(), code) != codes.end();
    };
    if (listed(map_.exceptions.not_permitted)) return Status::kNotPermitted;
    return listed(map_.exceptions.retry) ? Status::kBusBusy : Status::kBusException;
  }

  /// "SunS", then blocks of id, length, registers, until id 0xFFFF.
  Status walk_models(std::uint16_t base, bool& found) {
    constexpr int kModelsMax = 64;  // a device that answers nonsense must not hold the loop
    std::uint16_t head[2] = {};
    if (const Status status = read_at(base, head); status != Status::kOk) return status;
    if (head[0] != 0x5375 || head[1] != 0x6E53) return Status::kImplausible;
    found = true;
    unsigned located = 0;  // one bit for each model of the map
    int address = base + 2;
    for (int i = 0; i < kModelsMax && address < 65'534; ++i, address += 2 + head[1]) {
      const Status status = read_at(address, head);
      if (status != Status::kOk) {
        found = false;
        return status;
      }
      if (head[0] == 0xFFFF) break;
      for (int m = 0; m < map_.models.size(); ++m) {
        if (map_.models[m] != head[0]) continue;
        model_start_[m] = static_cast<std::uint16_t>(address);
        located |= 1U << m;
      }
    }
    return do_without(located) ? Status::kOk : Status::kImplausible;
  }

  /// A model that holds nothing but optional points need not be there.
  bool do_without(unsigned located) {
    for (int m = 0; m < map_.models.size(); ++m) {
      if ((located >> m & 1U) != 0) continue;
      bool is_needed = true;
      for (int i = 0; i < map_.points.size(); ++i) {
        if (map_.points[i].model != m) continue;
        if (!map_.points[i].optional) return false;
        is_needed = false;
        missing_.push_back({.place = {}, .point = static_cast<std::int8_t>(i)});
      }
      if (is_needed) return false;
    }
    return true;
  }

  Status read_at(int address, std::uint16_t (&registers)[2]) {
    return read_span({.unit = unit_, .address = static_cast<std::uint16_t>(address), .count = 2},
                     registers);
  }

  const RegisterMap& map_;
  Time time_;
  std::int32_t unit_;
  Link link_;
  LivePoints live_;
  PlacedPoints missing_;  ///< optional points that this device does not have
  std::int64_t read_ns_[kPointsMax] = {};
  std::int64_t last_read_ns_ = 0;
  std::uint16_t model_start_[decltype(RegisterMap::models)::capacity()] = {};
};

}  // namespace bess
