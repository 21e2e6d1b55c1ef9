// Load of the simulated house behind the same meter as the battery, by minutes: constant, from a
// CSV file, or drawn from a seed. Negative: PV surplus. Repeats after its end.
//   grid power = house load + battery power
#pragma once

#include <cstdint>
#include <mutex>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace bess {

class HouseLoad {
 public:
  static HouseLoad constant(double power_w);
  /// One year of a household: refrigerator, evenings, kettle, oven, washing; 0.2 to 8 kW, hours
  /// UTC.
  static HouseLoad daily(std::uint64_t seed);
  /// `minute_utc,house_w`, exactly one row per minute. Throws UserError naming the line.
  static HouseLoad from_csv(std::string_view text, std::string_view name);
  /// "daily", power in W, or a CSV file. Throws UserError.
  static HouseLoad from_option(const std::string& text, std::uint64_t seed);

  /// Constant within a minute.
  [[nodiscard]] double power_w(std::int64_t utc_s) const;

 private:
  HouseLoad(std::int64_t start_utc_s, std::vector<double> minutes)
      : start_utc_s_(start_utc_s), minutes_(std::move(minutes)) {}

  std::int64_t start_utc_s_;
  std::vector<double> minutes_;  ///< W, never empty
};

/// Shared by the servers of battery and meter: access to the battery requires `plant`.
struct MeteredHouse {
  explicit MeteredHouse(HouseLoad house) : load(std::move(house)) {}
  HouseLoad load;
  std::mutex plant;
};

}  // namespace bess
