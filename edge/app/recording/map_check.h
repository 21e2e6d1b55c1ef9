// Register map check: compares a map with the exchanges of a recording. For every point it reports
// whether its values are plausible and, if not, a correction. Two kinds of evidence:
//   single points    no answer, out of range; then other scale, word order and type are tried
//   several points   energy_evidence.h
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "edge/app/recording/energy_evidence.h"
#include "edge/device/registers/point_values.h"
#include "edge/device/registers/register_map.h"
#include "shared/bus_exchange.h"

namespace bess {

/// Result for one point.
struct PointVerdict {
  std::string name;
  std::int32_t unit = 0;
  int address = -1;  ///< PDU address; -1 = SunSpec model not found
  std::int64_t answers = 0;
  bool has_values = false;
  std::int64_t value_min = 0;  ///< of the plausible values
  std::int64_t value_max = 0;
  std::string finding;  ///< error and correction, one line; empty = plausible
};

class MapCheck {
 public:
  /// `unit` replaces the map's unit id if not negative. `map` must outlive this object.
  MapCheck(const RegisterMap& map, std::int32_t unit);

  /// Adds every exchange of a recording, in order.
  void add(const BusExchange& exchange);

  /// One verdict per point of the map, in its order.
  [[nodiscard]] std::vector<PointVerdict> verdicts() const;
  /// One line if sign and scale of the power were not checked; else empty.
  [[nodiscard]] std::string unjudged() const;

 private:
  struct PointStatistics {
    std::int64_t asked = 0;
    std::int64_t answers = 0;
    std::int64_t absent = 0;    ///< answers "not implemented"
    std::int64_t unscaled = 0;  ///< answers without a value of the scale point
    std::int64_t bad = 0;       ///< out of range
    std::int64_t strange = 0;   ///< failed identity checks
    int exception = 0;          ///< of the newest refusal
    std::int64_t good = 0;
    std::int64_t value_min = 0, value_max = 0;
    std::array<std::uint16_t, kPointRegistersMax> bad_raw{};  ///< the first
    Scaling bad_scaling;
    std::int64_t strange_value = 0;
  };

  void take(const BusExchange& exchange, int point, int offset);
  void take_value(int point, const std::uint16_t* raw);
  void judge_identity(int point, const std::uint16_t* raw, std::int64_t value);
  [[nodiscard]] bool begins_round(const BusExchange& exchange) const;
  void end_round();
  void note_order(std::int64_t utc_ns);
  [[nodiscard]] std::string finding_of(int point) const;
  [[nodiscard]] std::string range_finding(int point) const;
  [[nodiscard]] std::string unanswered_finding(int point) const;
  [[nodiscard]] std::string energy_finding(int point) const;
  [[nodiscard]] std::string power_finding(double capacity_wh) const;
  [[nodiscard]] std::string soc_finding(double capacity_wh) const;
  [[nodiscard]] double capacity_wh() const;
  [[nodiscard]] bool is_needed(int point) const;

  const RegisterMap& map_;
  PointPlaces places_;
  PointValues live_;
  std::array<PointStatistics, kPointsMax> seen_{};
  EnergyEvidence energy_;
  std::array<bool, kPointsMax> in_round_{};  ///< read since the newest round began
  std::int64_t power_utc_ns_ = 0;            ///< of the power in it
  std::optional<std::int64_t> order_w_;      ///< in force, if known
  std::int64_t order_since_ns_ = 0;
  int soc_, capacity_;           ///< points; -1 = not in this map
  int power_ = -1, order_ = -1;  ///< first points of measured and ordered power
};

}  // namespace bess
