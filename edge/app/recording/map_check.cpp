#include "edge/app/recording/map_check.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "edge/device/registers/point_codec.h"
#include "shared/host/text.h"
#include "shared/scaled_clock.h"

namespace bess {
namespace {

constexpr double kFactorMax = 3;  // far above efficiency, rounding and pauses

int first_term(const StaticVector<PowerCase, 4>& cases) {
  for (const PowerCase& c : cases) {
    if (!c.terms.empty()) return c.terms[0].point;
  }
  return -1;
}

/// "10 times" for 9.7, "a 100th" for 0.0102: typical errors of a scale.
std::string decimal_factor(double factor) {
  const double size = std::abs(factor);
  const int power = static_cast<int>(std::lround(std::log10(size)));
  if (power > 0) return formatted("%.0f times as much as", std::pow(10, power));
  if (power < 0) return formatted("a %.0fth of what", std::pow(10, -power));
  return formatted("%.1f times as much as", size);
}

std::string raw_text(const RegisterPoint& p, const std::uint16_t* raw) {
  std::string text = "[";
  for (int i = 0; i < p.registers; ++i) {
    text.append(i == 0 ? "" : " ").append(std::to_string(raw[i]));
  }
  return text + "]";
}

/// Another type, word order or scale with a value in range; empty if none.
std::string what_would_fit(const RegisterPoint& point, const std::uint16_t* raw,
                           const Scaling& scaling) {
  std::int64_t value = 0;
  const auto fits = [&](const RegisterPoint& other) {
    // 0 is in nearly every range and proves nothing.
    return decode(other, raw, value, scaling) && value != 0;
  };
  RegisterPoint other = point;
  if (point.registers > 1) {
    const bool is_high_first = point.word_order == WordOrder::kHighFirst;
    other.word_order = is_high_first ? WordOrder::kLowFirst : WordOrder::kHighFirst;
    if (fits(other)) {
      return std::string("word_order = \"") + (is_high_first ? "low_first" : "high_first") + "\"";
    }
    other = point;
  }
  constexpr struct {
    RegisterType is, could_be;
    const char* name;
  } kOtherSign[] = {{RegisterType::kU16, RegisterType::kS16, "s16"},
                    {RegisterType::kS16, RegisterType::kU16, "u16"},
                    {RegisterType::kU32, RegisterType::kS32, "s32"},
                    {RegisterType::kS32, RegisterType::kU32, "u32"}};
  for (const auto& type : kOtherSign) {
    if (point.type != type.is || point.mask != 0) continue;
    other.type = type.could_be;
    if (fits(other)) return std::string("type = \"") + type.name + "\"";
    other = point;
  }
  for (const std::int32_t factor : {10, 100, 1'000}) {
    other.scale_divisor = point.scale_divisor * factor;
    if (fits(other)) return "a scale " + std::to_string(factor) + " times smaller";
    other.scale_divisor = point.scale_divisor;
    other.scale = point.scale * factor;
    if (fits(other)) return "a scale " + std::to_string(factor) + " times larger";
    other.scale = point.scale;
  }
  return "";
}

/// Value without the range of the map; false if it cannot be decoded.
bool decode_anything(RegisterPoint point, const std::uint16_t* raw, const Scaling& scaling,
                     std::int64_t& value) {
  point.value_min = std::numeric_limits<std::int64_t>::min();
  point.slack = 0;
  point.unknown_is_max = false;
  point.value_max = std::numeric_limits<std::int64_t>::max();
  return decode(point, raw, value, scaling);
}

}  // namespace

MapCheck::MapCheck(const RegisterMap& map, std::int32_t unit)
    : map_(map),
      places_(map, unit),
      energy_(map.response.settle_s),
      soc_(find_point(map, "soc")),
      capacity_(find_point(map, "capacity")),
      power_(first_term(map.measured_power)),
      order_(first_term(map.order_power)) {}

void MapCheck::add(const BusExchange& exchange) {
  places_.follow(exchange);
  if (begins_round(exchange)) end_round();
  for (int i = 0; i < map_.points.size(); ++i) {
    const int offset = places_.offset_in(exchange, i);
    if (offset >= 0) take(exchange, i, offset);
  }
  note_order(exchange.utc_ns);
}

/// Measured points are read in rounds. A round ends when a point is read again, or at an order.
bool MapCheck::begins_round(const BusExchange& exchange) const {
  if (exchange.is_write()) return true;
  for (int i = 0; i < map_.points.size(); ++i) {
    if (in_round_[i] && places_.offset_in(exchange, i) >= 0) return true;
  }
  return false;
}

void MapCheck::end_round() {
  const bool has_power = power_ >= 0 && in_round_[power_];
  in_round_ = {};
  EnergyReading reading{.utc_ns = power_utc_ns_,
                        .soc_e4 = {},
                        .order_w = order_w_,
                        .order_age_s = (power_utc_ns_ - order_since_ns_) / kNanosecondsPerSecond};
  if (!has_power || !live_power(map_, map_.measured_power, live_, reading.power_w)) return;
  std::int64_t soc_e4 = 0;
  if (soc_ >= 0 && live_value(map_, live_, soc_, soc_e4)) reading.soc_e4 = soc_e4;
  energy_.add(reading);
}

void MapCheck::note_order(std::int64_t utc_ns) {
  std::int64_t power_w = 0;
  std::optional<std::int64_t> order_w;
  if (live_all(map_, map_.active, live_) && live_power(map_, map_.order_power, live_, power_w)) {
    order_w = power_w;
  }
  if (order_w != order_w_) order_since_ns_ = utc_ns;
  order_w_ = order_w;
}

void MapCheck::take(const BusExchange& exchange, int point, int offset) {
  if (exchange.is_write()) {
    if (exchange.outcome == BusOutcome::kAnswered) {
      live_.keep(map_, point, exchange.registers.data() + offset);
    }
    return;
  }
  PointStatistics& seen = seen_[point];
  ++seen.asked;
  // One refused register refuses its whole block: only a point read separately counts as refused.
  const bool is_alone = exchange.count == map_.points[point].registers;
  if (exchange.outcome == BusOutcome::kException && is_alone) seen.exception = exchange.exception;
  if (exchange.outcome != BusOutcome::kAnswered) return;
  ++seen.answers;
  in_round_[point] = true;
  if (point == power_) power_utc_ns_ = exchange.utc_ns;
  take_value(point, exchange.registers.data() + offset);
}

void MapCheck::take_value(int point, const std::uint16_t* raw) {
  const RegisterPoint& p = map_.points[point];
  PointStatistics& seen = seen_[point];
  if (p.type == RegisterType::kText) return judge_identity(point, raw, 0);
  live_.keep(map_, point, raw);
  Scaling scaling;
  std::int64_t value = 0;
  if (is_not_implemented(p, raw)) {
    ++seen.absent;
  } else if (!live_scaling(map_, live_, point, scaling)) {
    ++seen.unscaled;
  } else if (!decode(p, raw, value, scaling)) {
    if (++seen.bad > 1) return;
    std::copy_n(raw, p.registers, seen.bad_raw.begin());
    seen.bad_scaling = scaling;
  } else {
    seen.value_min = seen.good == 0 ? value : std::min(seen.value_min, value);
    seen.value_max = seen.good == 0 ? value : std::max(seen.value_max, value);
    ++seen.good;
    judge_identity(point, raw, value);
  }
}

void MapCheck::judge_identity(int point, const std::uint16_t* raw, std::int64_t value) {
  const bool is_text = map_.points[point].type == RegisterType::kText;
  for (const IdentityCheck& check : map_.identity) {
    if (check.point != point) continue;
    const bool is_right =
        is_text ? decode_text(map_.points[point], raw).view().starts_with(check.text.view())
                : value >= check.value_min && value <= check.value_max;
    if (is_right) continue;
    ++seen_[point].strange;
    seen_[point].strange_value = value;
  }
}

std::vector<PointVerdict> MapCheck::verdicts() const {
  std::vector<PointVerdict> verdicts;
  for (int i = 0; i < map_.points.size(); ++i) {
    const PointStatistics& seen = seen_[i];
    verdicts.push_back({.name = std::string(map_.points[i].name.view()),
                        .unit = places_.unit_of(i),
                        .address = places_.is_placed(i) ? places_.address_of(i) : -1,
                        .answers = seen.answers,
                        .has_values = seen.good > 0,
                        .value_min = seen.value_min,
                        .value_max = seen.value_max,
                        .finding = finding_of(i)});
  }
  return verdicts;
}

std::string MapCheck::finding_of(int point) const {
  const PointStatistics& seen = seen_[point];
  if (seen.answers == 0) return unanswered_finding(point);
  if (seen.bad > 0) return range_finding(point);
  if (seen.strange > 0) {
    for (const IdentityCheck& check : map_.identity) {
      if (check.point != point) continue;
      const bool is_text = map_.points[point].type == RegisterType::kText;
      return (is_text ? "does not begin with \"" + std::string(check.text.view()) + "\""
                      : "reads " + std::to_string(seen.strange_value)) +
             ": " + std::string(check.hint.view());
    }
  }
  if (seen.good == 0 && seen.unscaled > 0) {
    const RegisterPoint& p = map_.points[point];
    const int scale = p.scale_from >= 0 ? p.scale_from : p.percent_of;
    return "has no value: no answer for its scale " + std::string(map_.points[scale].name.view());
  }
  if (seen.good == 0 && seen.absent > 0 && is_needed(point)) {
    return "not implemented by the device, in " + std::to_string(seen.absent) + " answers";
  }
  return energy_finding(point);
}

/// The controller needs this point.
bool MapCheck::is_needed(int point) const {
  const bool is_measured = std::ranges::count(map_.measure, point) > 0;
  const bool identifies = std::ranges::count(map_.identity, point, &IdentityCheck::point) > 0;
  return (is_measured || identifies) && !map_.points[point].optional;
}

std::string MapCheck::unanswered_finding(int point) const {
  const PointStatistics& seen = seen_[point];
  // Points that are optional, only written, or read on demand are not reported as missing.
  const bool is_asked_for = seen.asked > 0 && !places_.is_written(point);
  if (map_.points[point].optional || !(is_needed(point) || is_asked_for)) return "";
  if (!places_.is_placed(point)) {
    return "its SunSpec model " + std::to_string(map_.models[map_.points[point].model]) +
           " not found";
  }
  if (seen.asked == 0) return "never read in this recording";
  if (seen.exception != 0) {
    return "never answered: exception " + std::to_string(seen.exception) +
           (seen.exception == 2 ? ", no such register" : "");
  }
  return "never answered, in " + std::to_string(seen.asked) + " readings";
}

std::string MapCheck::range_finding(int point) const {
  const RegisterPoint& p = map_.points[point];
  const PointStatistics& seen = seen_[point];
  std::int64_t value = 0;
  const bool is_number = decode_anything(p, seen.bad_raw.data(), seen.bad_scaling, value);
  const std::string fit = what_would_fit(p, seen.bad_raw.data(), seen.bad_scaling);
  return "reads " + (is_number ? std::to_string(value) : "no number") + " " +
         raw_text(p, seen.bad_raw.data()) + ", expected " + std::to_string(p.value_min) + " to " +
         std::to_string(p.value_max) + ", in " + std::to_string(seen.bad) + " of " +
         std::to_string(seen.answers) + " answers" + (fit.empty() ? "" : "; try " + fit);
}

double MapCheck::capacity_wh() const {
  std::int64_t value = 0;
  if (capacity_ < 0 || !live_value(map_, live_, capacity_, value)) return 0;
  return static_cast<double>(value);
}

std::string MapCheck::energy_finding(int point) const {
  const double capacity = capacity_wh();
  if (point == power_) return power_finding(capacity);
  if (point == soc_) return soc_finding(capacity);
  const bool is_power_right = energy_.soc_per_energy(1).value_or(0) > 0;
  if (point == order_ && is_power_right && energy_.answer() == EnergyEvidence::Answer::kOpposite) {
    return "power flows against this order, and the state of charge follows the power: wrong sign";
  }
  return "";
}

/// A wrong scale of the power also differs from the order; without orders, it may be any of three.
std::string MapCheck::power_finding(double capacity) const {
  const bool knows_capacity = capacity > 0;
  const auto ratio = energy_.soc_per_energy(knows_capacity ? capacity : 1);
  if (!ratio.has_value()) return "";
  if (*ratio < 0)
    return "the state of charge falls while charging and rises while discharging: wrong sign";
  const bool is_far_off = *ratio > kFactorMax || *ratio < 1 / kFactorMax;
  if (!knows_capacity || !is_far_off) return "";
  const double by_order = energy_.power_per_order().value_or(0);
  if (by_order > 0.5 && by_order < 1.5) return "";  // wrong scale of SoC or capacity
  return "the state of charge changes " + decimal_factor(*ratio) +
         " this power explains: wrong scale of this, of soc or of capacity";
}

std::string MapCheck::soc_finding(double capacity) const {
  constexpr double kCapacityUnknownWh = 20'000;
  if (energy_.soc_stands_still(capacity > 0 ? capacity : kCapacityUnknownWh)) {
    return formatted("does not change, although %.0f Wh have flowed", energy_.energy_moved_wh());
  }
  const auto ratio = energy_.soc_per_energy(capacity);
  if (capacity <= 0 || !ratio.has_value() || *ratio < 0) return "";
  const double by_order = energy_.power_per_order().value_or(0);
  const bool is_power_right = by_order > 0.5 && by_order < 1.5;
  if (!is_power_right || (*ratio <= kFactorMax && *ratio >= 1 / kFactorMax)) return "";
  return "changes " + decimal_factor(*ratio) +
         " the measured power explains, which is as ordered: wrong scale of this or of capacity";
}

std::string MapCheck::unjudged() const {
  if (power_ < 0 || soc_ < 0 || energy_.soc_per_energy(1).has_value()) return "";
  if (!soc_finding(capacity_wh()).empty()) return "";
  return "sign and scale of the power not checked: the state of charge changed too little in the "
         "recording";
}

}  // namespace bess
