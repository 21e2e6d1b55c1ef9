// Commissioning of batteries with every dead time, time constant, ramp, noise and read-out, in
// moved time: accepted if their largest step is within settle_s, refused if not, and the printed
// value passes when it is set.
//
// The batteries are independent of bess-sim and of the fitted model.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "edge/device/battery/commission.h"
#include "tests/support/fake_plant.h"
#include "tests/support/thorough.h"

namespace bess {
namespace {

enum class Ramped { kSetpoint, kPower };  ///< upper limit of its rate of change

struct Nature {
  double dead_time_s = 0;
  double time_constant_s = 0;
  double ramp_w_per_s = 1e9;
  double noise_frac = 0;  ///< standard deviation, in addition to 10 W
  double read_s = 0.05;   ///< duration of a reading; it is true at any instant within
  double refresh_s = 0;   ///< update period of its registers; 0 = always
  Ramped ramped = Ramped::kSetpoint;
};

constexpr double kStepS = 0.02;

/// Real power, in steps of 20 ms.
struct Plant {
  Nature nature;
  double ordered_w = 0;
  double before_w = 0;
  double since_s = 1e9;
  double setpoint_w = 0;
  double power_w = 0;

  void order(double w) {
    before_w = since_s < nature.dead_time_s ? before_w : ordered_w;
    ordered_w = w;
    since_s = 0;
  }
  void step() {
    since_s += kStepS;
    const double wanted_w = since_s < nature.dead_time_s ? before_w : ordered_w;
    const double reach_w = nature.ramp_w_per_s * kStepS;
    const bool ramps_setpoint = nature.ramped == Ramped::kSetpoint;
    setpoint_w = ramps_setpoint ? std::clamp(wanted_w, setpoint_w - reach_w, setpoint_w + reach_w)
                                : wanted_w;
    const double tau_s = nature.time_constant_s;
    const double lagged_w =
        tau_s == 0 ? setpoint_w : setpoint_w + (power_w - setpoint_w) * std::exp(-kStepS / tau_s);
    power_w =
        ramps_setpoint ? lagged_w : std::clamp(lagged_w, power_w - reach_w, power_w + reach_w);
  }
};

/// Time until a step is in its band, from rest: the truth.
double seconds_of(const Nature& nature, double step_w, double band_w) {
  Plant plant{.nature = nature, .ordered_w = -step_w / 2};
  plant.setpoint_w = plant.power_w = -step_w / 2;
  plant.order(step_w / 2);
  double outside_s = 0;
  for (double s = 0; s < 600; s += kStepS) {
    plant.step();
    if (std::abs(plant.power_w - step_w / 2) > band_w) outside_s = s + kStepS;
  }
  return outside_s;
}

struct GridBattery {
  FakeClock& clock;
  Plant plant;
  std::mt19937_64 random;
  double soc_frac = 0.5;
  std::int64_t stepped_ns = clock.now_ns;
  double shown_w = 0;
  double shown_s = -1e9;
  bool is_driven = false;

  void advance() {
    for (; stepped_ns + 20'000'000 <= clock.now_ns; stepped_ns += 20'000'000) plant.step();
    const double now_s =
        static_cast<double>(clock.now_ns - kDayStartS * kNanosecondsPerSecond) / 1e9;
    if (now_s - shown_s < plant.nature.refresh_s) return;
    shown_s = now_s;
    const double noise_w = 10 + plant.nature.noise_frac * std::abs(plant.power_w);
    shown_w = plant.power_w + std::normal_distribution<>(0, noise_w)(random);
  }
  Status read(BatteryMeasurement& m) {
    const double share = std::uniform_real_distribution<>(0, 1)(random);
    const auto read_ns = static_cast<std::int64_t>(plant.nature.read_s * 1e9);
    const auto before_ns = static_cast<std::int64_t>(static_cast<double>(read_ns) * share);
    clock.now_ns += before_ns;
    advance();
    clock.now_ns += read_ns - before_ns;
    m = BatteryMeasurement{};
    m.soc_e4 = static_cast<std::int32_t>(soc_frac * 1e4);
    m.power_w = static_cast<std::int32_t>(std::lround(shown_w));
    m.dispatch_active = is_driven;
    return Status::kOk;
  }
  Status order(const PowerOrder& o) {
    advance();
    plant.order(o.power_w);
    is_driven = true;
    clock.now_ns += 50'000'000;
    return Status::kOk;
  }
  [[nodiscard]] static std::int32_t refresh_interval_s() { return 0; }
  static Status refresh() { return Status::kOk; }
  static Status release() { return Status::kOk; }
};

CommissionResult commission(const Nature& nature, std::uint64_t seed,
                            const CommissionSettings& settings, double soc_frac = 0.5) {
  FakeClock clock;
  GridBattery battery{.clock = clock,
                      .plant = {.nature = nature},
                      .random = std::mt19937_64(seed),
                      .soc_frac = soc_frac};
  return SignCheck<GridBattery, FakeClock>(settings, battery, clock).run();
}

/// Uncertainty of the truth: an unknown instant, and registers of that age.
double unseen_s(const Nature& nature) { return nature.read_s + nature.refresh_s + 0.1; }

std::vector<Nature> natures() {
  std::vector<Nature> all;
  for (const double dead_s : {0.0, 2.0, 8.0}) {
    for (const double tau_s : {0.0, 1.0, 3.0, 5.0, 12.0, 25.0}) {
      for (const double ramp : {1e9, 2'000.0, 500.0, 150.0, 30.0}) {
        for (const double noise : {0.0, 0.01, 0.03}) {
          for (const auto& [read_s, refresh_s] : {std::pair{0.05, 0.0}, {2.0, 0.0}, {0.05, 3.0}}) {
            Nature nature{dead_s, tau_s, ramp, noise, read_s, refresh_s};
            nature.ramped = all.size() % 2 == 0 ? Ramped::kSetpoint : Ramped::kPower;
            all.push_back(nature);
          }
        }
      }
    }
  }
  return all;
}

std::string text_of(const Nature& n) {
  return fmt::format(
      "dead {} s, time constant {} s, ramp {} W/s ({}), noise {}, read {} s, refresh {} s",
      n.dead_time_s, n.time_constant_s, n.ramp_w_per_s,
      n.ramped == Ramped::kPower ? "power" : "setpoint", n.noise_frac, n.read_s, n.refresh_s);
}

bool passes(const CommissionResult& r) { return r.verdict == CommissionVerdict::kPassed; }
bool is_doubtful(const CommissionResult& r) {
  return r.charge.speed.is_doubtful || r.discharge.speed.is_doubtful;
}

/// Of the largest step, less the part hidden by noise and readings.
struct Truth {
  bool is_within = false;
  bool is_beyond = false;
};
Truth truth_of(const Nature& nature, const CommissionSettings& settings) {
  const StepResponseCriteria criteria{.response = settings.response, .rated_w = settings.rated_w};
  const double band_w = criteria.band_w(settings.step_w_max);
  const double noise_w = 2 * (10 + nature.noise_frac * settings.step_w_max / 2);
  const double latest_s = seconds_of(nature, settings.step_w_max, band_w - noise_w);
  const double soonest_s = seconds_of(nature, settings.step_w_max, band_w + noise_w);
  return {.is_within = latest_s + unseen_s(nature) <= settings.response.settle_s,
          .is_beyond = soonest_s > settings.response.settle_s + unseen_s(nature)};
}

/// Where a larger step fits both ways, one beyond is refused; otherwise it may be a warning.
bool is_right(const CommissionResult& r, const Truth& truth, bool has_room) {
  const bool is_known = passes(r) || r.verdict == CommissionVerdict::kSlow;
  if (!is_known || (truth.is_within && !passes(r))) return false;
  return !truth.is_beyond || !passes(r) || (!has_room && is_doubtful(r));
}

std::size_t every_of(int few, int all) { return static_cast<std::size_t>(few_or_all(few, all)); }

/// Of every Nth battery.
void expect_none_wrong(const CommissionSettings& settings, double soc_frac, std::size_t every) {
  const bool has_room = soc_frac == 0.5;
  std::uint64_t seed = 20'261'125;
  const std::vector<Nature> all = natures();
  for (std::size_t i = 0; i < all.size(); i += every) {
    const Nature& nature = all[i];
    const Truth truth = truth_of(nature, settings);
    const CommissionResult result = commission(nature, ++seed, settings, soc_frac);
    bool is_wrong = !is_right(result, truth, has_room);
    if (!passes(result)) {
      CommissionSettings reported = settings;  // the printed value, configured: it must pass
      if (result.wanted_settle_s > 0) reported.response.settle_s = result.wanted_settle_s;
      if (result.wanted_ramp_w_max > 0) reported.step_w_max = result.wanted_ramp_w_max;
      is_wrong = is_wrong || !passes(commission(nature, seed, reported, soc_frac));
    }
    if (!is_wrong) continue;
    ADD_FAILURE() << text_of(nature) << ": " << commission_text(result.verdict) << " "
                  << result.wanted_settle_s << " s, " << result.wanted_ramp_w_max << " W";
  }
}

TEST(CommissionGrid, RefusesTheSlowAndNoOther) { expect_none_wrong({}, 0.5, every_of(5, 1)); }
TEST(CommissionGrid, WithoutRoomItWarnsOfWhatItCannotMeasure) {
  expect_none_wrong({}, 0.97, every_of(17, 5));
}
TEST(CommissionGrid, OfALargerBatteryThatMayTakeAMinute) {
  CommissionSettings settings{.rated_w = 30'000, .step_w_max = 20'000};
  settings.response.settle_s = 60;
  expect_none_wrong(settings, 0.5, every_of(17, 5));
}

}  // namespace
}  // namespace bess
