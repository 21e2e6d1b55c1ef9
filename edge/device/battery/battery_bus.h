// Battery bus: points of a register map over a link. Locates them (unit groups, SunSpec models),
// finds the optional ones, reads outdated values, writes blocks, and decides which errors deserve a
// retry. A template over link and time: Modbus, or registers in memory in tests.
//
//   Link   Status read(const RegisterSpan&, uint16_t*); Status write(unit, function, address,
//          const uint16_t*, count, send_until_ns); void close(); int last_exception() const
//   Time   int64 now_ns(); void sleep_ms(int); int64 utc_day()
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <utility>

#include "edge/core/base/status.h"
#include "edge/device/battery/measurement_reader.h"
#include "edge/device/battery/modbus_frame.h"
#include "edge/device/registers/point_values.h"
#include "shared/scaled_clock.h"

namespace bess {

inline constexpr int kBusAttempts = 2;  // a dropped connection is restored immediately
// Additional retry time for a busy, silent or disconnected device, in its own time. A reading
// begins some seconds before its tick; both end within the order's deadline.
inline constexpr std::int64_t kReadPatienceNs = 20 * kNanosecondsPerSecond;
inline constexpr std::int64_t kOrderPatienceNs = 30 * kNanosecondsPerSecond;
inline constexpr std::int64_t kPresencePatienceNs = 5 * kNanosecondsPerSecond;
inline constexpr std::int32_t kRetryPauseMs = 1'000;

/// Tries a request at least twice; after temporary failures until `patience_ns` is over.
template <typename Time, typename Request>
Status retried(const Time& time, std::int64_t patience_ns, Request request) {
  const std::int64_t end_ns = time.now_ns() + patience_ns;
  for (int attempt = 1;; ++attempt) {
    const Status status = request();
    if (!is_temporary(status) && status != Status::kNotApplied) return status;
    if (attempt < kBusAttempts) continue;
    if (!is_temporary(status) || time.now_ns() >= end_ns) return status;
    time.sleep_ms(kRetryPauseMs);
  }
}

template <typename Link, typename Time>
class BatteryBus {
 public:
  /// `unit` replaces the map's unit id if not negative. `map` must outlive this object.
  template <typename... LinkArguments>
  BatteryBus(const RegisterMap& map, const Time& time, std::int32_t unit, LinkArguments&&... link)
      : map_(map),
        time_(time),
        unit_(unit >= 0 ? unit : map.unit),
        link_(std::forward<LinkArguments>(link)...) {}

  [[nodiscard]] const PointValues& live() const { return live_; }
  [[nodiscard]] const Time& time() const { return time_; }
  [[nodiscard]] Link& link() { return link_; }
  [[nodiscard]] const Link& link() const { return link_; }
  /// Last complete reading of required and scaling values; 0 = never.
  [[nodiscard]] std::int64_t last_read_ns() const { return last_read_ns_; }

  /// Locates the models of the map's points: tries every base, whatever the others return.
  /// kImplausible: `missing_model` does not exist. Earlier results are kept.
  Status locate_models(std::uint16_t& missing_model) {
    missing_model = 0;
    if (map_.models.empty()) return Status::kOk;
    Status elsewhere = Status::kImplausible;  // status of bases without a marker
    for (const std::uint16_t base : map_.model_bases) {
      bool is_marked = false;
      const Status status = walk_models(base, is_marked, missing_model);
      if (is_marked || status == Status::kNotConnected) return status;
      if (is_temporary(status)) elsewhere = status;
    }
    missing_model = map_.models[0];
    return elsewhere;
  }

  /// Determines the optional points of this device. A point seen once is required from then on;
  /// others are tried each time, because the device may not have been ready.
  Status find_optional_points() {
    PlacedPoints undecided;
    for (const std::int8_t point : map_.measure) {
      if (!map_.points[point].optional || is_present_[point]) continue;
      live_.absent[point] = true;
      if (is_located(point)) undecided.push_back(placed(point, map_.points[point].read_function));
    }
    refused_.clear();
    ReadPlan plan;
    plan_reads(map_, undecided, refused_, plan);
    for (const RegisterSpan& span : plan) {
      if (const Status status = decide(span, undecided); status != Status::kOk) return status;
    }
    return Status::kOk;
  }
  /// Optional point that an earlier run saw on this device.
  void require(std::int8_t point) { is_present_[point] = true; }

  /// Reads every measured point with an outdated value.
  Status read_due() {
    ++round_;
    return read_rest();
  }

  /// As `read_due`, without values received since the last `read_due`.
  Status read_rest() {
    PlacedPoints due;
    for (const std::int8_t point : map_.measure) {
      const bool has_come = !live_.failed[point] && read_in_round_[point] == round_;
      const bool is_there = !map_.points[point].optional || is_present_[point];
      if (is_there && !has_come && !is_fresh(point))
        due.push_back(placed(point, map_.points[point].read_function));
    }
    const Status status = read_placed(due, live_);
    const auto has_failed = [&](std::int8_t point) { return live_.failed[point]; };
    const auto none_failed = [&](const auto& points) {
      return std::none_of(points.begin(), points.end(), has_failed);
    };
    if (none_failed(map_.required) && none_failed(map_.scales)) last_read_ns_ = time_.now_ns();
    return status;
  }

  Status read_points(const StaticVector<std::int8_t, kPointsMax>& points) {
    PlacedPoints due;
    for (const std::int8_t point : points) {
      due.push_back(placed(point, map_.points[point].read_function));
    }
    return read_placed(due, live_);
  }

  /// Reads `points` into `out`; failed ones are marked there and do not stop the others. Of several
  /// failures a temporary one is returned.
  Status read_placed(PlacedPoints& points, PointValues& out) {
    ReadPlan plan;
    plan_reads(map_, points, refused_, plan);
    for (const PlacedPoint& point : points) out.failed[point.point] = true;
    Status worst = Status::kOk;
    bool was_answered = false;
    for (const RegisterSpan& span : plan) {
      Status status = read_into(span, points, out);
      was_answered = was_answered || status == Status::kOk || link_.last_exception() != 0;
      if (status == Status::kBusException) status = read_apart(span, points, out);
      if (status != Status::kOk && !is_temporary(worst)) worst = status;
      // With a silent device the rest would cost a time-out each.
      if (status == Status::kNotConnected || !was_answered) break;
    }
    return worst;
  }

  /// `function` 3 for written points, independent of the table of their reading.
  [[nodiscard]] PlacedPoint placed(std::int8_t point, std::uint8_t function) const {
    const RegisterPoint& p = map_.points[point];
    const int start = p.model < 0 ? 0 : model_start_[p.model];
    return {.place = {.unit = p.unit_group < 0 ? unit_ : map_.unit_of(p),
                      .address = static_cast<std::uint16_t>(start + p.address),
                      .count = p.registers,
                      .function = function},
            .point = point};
  }

  /// False: its model was not found.
  [[nodiscard]] bool is_located(std::int8_t point) const {
    const int model = map_.points[point].model;
    return model < 0 || model_start_[model] != 0;
  }

  Status read_point(std::int8_t point, std::uint16_t* registers) {
    if (!is_located(point)) return Status::kImplausible;
    return read_span(placed(point, map_.points[point].read_function).place, registers);
  }

  /// Not after `send_until_ns` (CLOCK_MONOTONIC).
  Status write(const BlockWrite& write, const RegisterBlock& block, std::int64_t send_until_ns) {
    if (!is_located(write.values[0].point)) return Status::kImplausible;
    const PlacedPoint first = placed(write.values[0].point, 3);
    const auto send = [&](std::uint8_t function) {
      return judged(link_.write(first.place.unit, function, first.place.address, block.data(),
                                block.size(), send_until_ns));
    };
    if (block.size() > 1) return send(write.function);
    // Some firmware accepts only one of the two functions for a single register.
    const std::uint8_t other = write.function == 6 ? 16 : 6;
    const Status status = send(writes_by_other_ ? other : write.function);
    if (status != Status::kBusException || link_.last_exception() > kExceptionNoAddress) {
      return status;
    }
    const Status second = send(writes_by_other_ ? write.function : other);
    // The exception of the second answer may hide a permanent first one, but not a time-out.
    if (second != Status::kOk) return is_temporary(second) ? second : status;
    writes_by_other_ = !writes_by_other_;
    return Status::kOk;
  }

 private:
  using ModelStarts = std::array<std::uint16_t, decltype(RegisterMap::models)::capacity()>;

  Status read_into(const RegisterSpan& span, const PlacedPoints& points, PointValues& out) {
    std::uint16_t registers[kSpanRegistersMax] = {};
    const Status status = read_span(span, registers);
    if (status != Status::kOk) return status;
    for (const PlacedPoint& point : points) {
      const int offset = offset_in(span, point);
      if (offset < 0) continue;
      out.keep(map_, point.point, registers + offset);
      if (&out != &live_) continue;
      read_ns_[point.point] = time_.now_ns();
      read_in_round_[point.point] = round_;
    }
    return Status::kOk;
  }

  /// A refused span may contain one missing register: the others still count.
  Status read_apart(const RegisterSpan& span, const PlacedPoints& points, PointValues& out) {
    Status worst = Status::kOk;
    for (const PlacedPoint& point : points) {
      if (offset_in(span, point) < 0) continue;
      const Status status = read_into(point.place, points, out);
      if (status != Status::kOk) worst = status;
    }
    return worst;
  }

  /// A point is absent if refused (by a gateway: for some seconds) or not implemented.
  Status decide(const RegisterSpan& span, const PlacedPoints& undecided) {
    PointValues now;
    const Status status =
        retried(time_, kPresencePatienceNs, [&] { return read_into(span, undecided, now); });
    if (status != Status::kOk && !has_no_such_register()) return status;
    for (const PlacedPoint& point : undecided) {
      const RegisterPoint& p = map_.points[point.point];
      if (offset_in(span, point) < 0) continue;
      if (status != Status::kOk) {
        const Status alone = read_into(point.place, undecided, now);
        if (alone != Status::kOk && !has_no_such_register()) return alone;
        if (alone != Status::kOk) refused_.push_back(point);
      }
      is_present_[point.point] =
          now.known[point.point] && !is_not_implemented(p, now.raw[point.point]);
      live_.absent[point.point] = !is_present_[point.point];
    }
    return Status::kOk;
  }

  bool is_fresh(std::int8_t point) const {
    const std::int64_t age_ns = time_.now_ns() - read_ns_[point];
    return live_.known[point] && !live_.failed[point] &&
           age_ns < map_.points[point].max_age_s * kNanosecondsPerSecond;
  }

  /// From the last reply: an illegal request, or no device behind a gateway.
  [[nodiscard]] bool has_no_such_register() const {
    constexpr int kIllegalDataValue = 3;
    const int code = link_.last_exception();
    return (code >= 1 && code <= kIllegalDataValue) || code == kExceptionNoPath ||
           code == kExceptionNoReply;
  }

  Status read_span(const RegisterSpan& span, std::uint16_t* registers) {
    return judged(link_.read(span, registers));
  }

  /// Status of an exception code, by the map's lists.
  Status judged(Status status) const {
    const int code = link_.last_exception();
    if (status == Status::kOk || code == 0) return status;
    const auto listed = [code](const auto& codes) {
      return std::find(codes.begin(), codes.end(), code) != codes.end();
    };
    if (listed(map_.exceptions.not_permitted)) return Status::kNotPermitted;
    return listed(map_.exceptions.retry) ? Status::kBusBusy : status_of_exception(code);
  }

  /// "SunS", then blocks of id, length, registers, until id 0xFFFF.
  Status walk_models(std::uint16_t base, bool& is_marked, std::uint16_t& missing_model) {
    constexpr int kModelsMax = 64;  // bounds the loop for invalid replies
    std::uint16_t head[2] = {};
    if (const Status status = read_at(base, head); status != Status::kOk) return status;
    is_marked = head[0] == 0x5375 && head[1] == 0x6E53;
    if (!is_marked) return Status::kImplausible;
    ModelStarts found = {};
    int address = base + 2;
    for (int i = 0; i < kModelsMax && address < 65'534; ++i, address += 2 + head[1]) {
      if (const Status status = read_at(address, head); status != Status::kOk) return status;
      if (head[0] == 0xFFFF) break;
      for (int m = 0; m < map_.models.size(); ++m) {
        if (map_.models[m] == head[0]) found[m] = static_cast<std::uint16_t>(address);
      }
    }
    for (int m = 0; m < map_.models.size(); ++m) {
      if (found[m] != 0 || !is_needed(m)) continue;
      missing_model = map_.models[m];
      return Status::kImplausible;
    }
    model_start_ = found;
    return Status::kOk;
  }

  /// A model with only optional points may be missing, unless one was seen.
  [[nodiscard]] bool is_needed(int model) const {
    bool is_used = false;
    for (int i = 0; i < map_.points.size(); ++i) {
      if (map_.points[i].model != model) continue;
      if (!map_.points[i].optional || is_present_[i]) return true;
      is_used = true;
    }
    return !is_used;
  }

  Status read_at(int address, std::uint16_t (&registers)[2]) {
    return read_span({.unit = unit_, .address = static_cast<std::uint16_t>(address), .count = 2},
                     registers);
  }

  const RegisterMap& map_;
  Time time_;
  std::int32_t unit_;
  Link link_;
  PointValues live_;
  PlacedPoints refused_;              ///< optional points that no span may cover
  bool is_present_[kPointsMax] = {};  ///< optional points that were seen once
  std::int64_t read_ns_[kPointsMax] = {};
  std::uint32_t read_in_round_[kPointsMax] = {};
  std::uint32_t round_ = 0;  ///< number of the reading, with its retries
  std::int64_t last_read_ns_ = 0;
  bool writes_by_other_ = false;  ///< single registers by the function not named in the map
  ModelStarts model_start_ = {};  ///< 0: not found
};

}  // namespace bess
