#include "tools/simulators/battery_sim/house_load.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <span>

#include "shared/host/csv.h"
#include "shared/host/file.h"
#include "shared/host/text.h"
#include "shared/host/user_error.h"

namespace bess {
namespace {

constexpr int kDays = 366;
constexpr int kMinutesOfDay = 1'440;

/// Load of one day, drawn at random.
class Day {
 public:
  Day(std::span<double> minutes, std::mt19937_64& random) : minutes_(minutes), random_(random) {}

  void draw() {
    for (int m = 0; m < kMinutesOfDay; ++m) minutes_[m] = 180 + (m % 45 < 15 ? 90 : 0);
    run(390, 60, 250, 60);                                // light and radio, morning
    run(1'020, 60, 350, 300);                             // evening
    for (int i = 0; i < 4; ++i) run(400, 800, 2'000, 4);  // kettle, coffee
    if (chance(0.8)) cook();
    if (chance(0.4)) run(480, 600, 2'100, 25);    // washing machine, heating
    if (chance(0.5)) run(1'140, 120, 1'900, 20);  // dishwasher
    if (chance(0.3)) run(540, 600, 2'600, 60);    // tumble dryer
  }

 private:
  [[nodiscard]] bool chance(double p) {
    return std::uniform_real_distribution<>(0, 1)(random_) < p;
  }
  [[nodiscard]] int drawn(int count) { return std::uniform_int_distribution<>(0, count)(random_); }

  /// Appliance that starts within `spread` minutes after `from`.
  void run(int from, int spread, double power_w, int minutes) {
    const int begin = from + drawn(spread);
    const int end = std::min(begin + minutes, kMinutesOfDay);
    for (int m = begin; m < end; ++m) minutes_[m] += power_w;
  }

  /// Oven and hob, with thermostat.
  void cook() {
    const int begin = 1'050 + drawn(90);
    for (int m = begin; m < begin + 40; ++m) minutes_[m] += m % 3 == 0 ? 3'600 : 1'400;
  }

  std::span<double> minutes_;
  std::mt19937_64& random_;
};

}  // namespace

HouseLoad HouseLoad::constant(double power_w) { return {0, {power_w}}; }

HouseLoad HouseLoad::daily(std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::vector<double> minutes(std::size_t{kDays} * kMinutesOfDay);
  for (int day = 0; day < kDays; ++day) {
    Day(std::span(minutes).subspan(std::size_t{kMinutesOfDay} * day, kMinutesOfDay), random).draw();
  }
  return {0, std::move(minutes)};
}

HouseLoad HouseLoad::from_csv(std::string_view text, std::string_view name) {
  const CsvTable table(text, std::string(name), "minute_utc,house_w");
  const std::int64_t start_utc_s = table.utc_s(0, 0);
  std::vector<double> minutes;
  for (std::size_t row = 0; row < table.row_count(); ++row) {
    if (table.utc_s(row, 0) != start_utc_s + 60 * std::ssize(minutes)) {
      fail("{}:{}: must be one minute after the previous row", name, table.line(row));
    }
    minutes.push_back(table.number(row, 1));
  }
  return {start_utc_s, std::move(minutes)};
}

HouseLoad HouseLoad::from_option(const std::string& text, std::uint64_t seed) {
  double power_w = 0;
  if (text == "daily") return daily(seed);
  if (read_number(text, power_w) && std::isfinite(power_w)) return constant(power_w);
  return from_csv(read_file(text), text);
}

double HouseLoad::power_w(std::int64_t utc_s) const {
  const std::int64_t count = std::ssize(minutes_);
  const std::int64_t minute = (utc_s - start_utc_s_) / 60 % count;
  return minutes_[static_cast<std::size_t>(minute < 0 ? minute + count : minute)];
}

}  // namespace bess
