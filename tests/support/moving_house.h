// Houses with fast load changes, drawn from a seed: the other load that a meter at the connection
// sees. One sample every 2 s, for days.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

namespace bess {

class MovingHouse {
 public:
  static constexpr int kSampleS = 2;
  static constexpr int kSamplesOfHour = 3'600 / kSampleS;

  /// Appliances of the house; all have a refrigerator and noise.
  struct Habits {
    const char* name;
    bool kitchen = false;    ///< kettle, oven by thermostat, washing machine, dishwasher
    double ev_w = 0;         ///< a car: sessions of hours, with pauses by its own controller
    double heat_pump_w = 0;  ///< on for 8 to 15 minutes, off as long
    bool hob = false;        ///< induction, 2 kW that pulses every 7 to 11 s, two hours a day
    double pv_w = 0;         ///< panels, and clouds that come within seconds
  };

  MovingHouse(const Habits& habits, std::int64_t start_utc_s, int days, std::uint64_t seed)
      : start_utc_s_(start_utc_s), random_(seed), watts_(std::size_t(days) * 24 * kSamplesOfHour) {
    draw_base();
    for (int day = 0; day < days; ++day) draw_day(habits, day);
    if (habits.heat_pump_w > 0) draw_heat_pump(habits.heat_pump_w);
    if (habits.pv_w > 0) draw_sun(habits.pv_w);
  }

  [[nodiscard]] double power_w(std::int64_t utc_s) const {
    const std::int64_t at = std::max<std::int64_t>(utc_s - start_utc_s_, 0) / kSampleS;
    return watts_[static_cast<std::size_t>(at) % watts_.size()];
  }

 private:
  double uniform(double from, double to) {
    return std::uniform_real_distribution<>(from, to)(random_);
  }
  [[nodiscard]] static std::size_t samples(double seconds) {
    return static_cast<std::size_t>(seconds / kSampleS);
  }
  void add(std::size_t from, double seconds, double power_w) {
    const std::size_t end = std::min(from + samples(seconds), watts_.size());
    for (std::size_t i = from; i < end; ++i) watts_[i] += static_cast<float>(power_w);
  }

  void draw_base() {
    std::normal_distribution<> step(0, 4);
    double noise = 0;
    for (std::size_t i = 0; i < watts_.size(); ++i) {
      noise = 0.98 * noise + step(random_);
      const bool fridge = i * kSampleS % 2'700 < 900;
      watts_[i] = static_cast<float>(220 + noise + (fridge ? 90 : 0));
    }
  }

  /// A start within a span of hours of the day.
  std::size_t start(int day, double from_h, double to_h) {
    return static_cast<std::size_t>((day * 24 + uniform(from_h, to_h)) * kSamplesOfHour);
  }

  void draw_day(const Habits& habits, int day) {
    if (habits.kitchen) draw_kitchen(day);
    if (habits.hob) draw_hob(day);
    if (habits.ev_w > 0) draw_car(day, habits.ev_w);
  }

  void draw_kitchen(int day) {
    for (int i = 0; i < 8; ++i) add(start(day, 6, 22), uniform(60, 240), uniform(1'800, 2'400));
    std::size_t at = start(day, 17, 19);
    for (int i = 0; i < 20; ++i) {  // the oven's thermostat
      const double on_s = uniform(25, 60);
      add(at, on_s, 3'200);
      at += samples(on_s + uniform(30, 90));
    }
    for (int i = 0; i < 2; ++i) {  // washing: heats now and then
      at = start(day, 8, 20);
      for (int heat = 0; heat < 3; ++heat) {
        add(at, uniform(120, 600), 2'100);
        at += samples(uniform(700, 1'500));
      }
    }
  }

  void draw_hob(int day) {
    for (int meal = 0; meal < 2; ++meal) {
      std::size_t at = start(day, meal == 0 ? 11 : 17, meal == 0 ? 12 : 19);
      for (int i = 0; i < 400; ++i, at += samples(uniform(7, 11))) add(at, 4, 2'000);
    }
  }

  void draw_car(int day, double power_w) {
    std::size_t at = start(day, 18, 23);
    for (int i = 0; i < 8; ++i) {
      const double on_s = uniform(120, 2'400);
      add(at, on_s, power_w);
      at += samples(on_s + uniform(20, 900));
    }
  }

  void draw_heat_pump(double power_w) {
    for (std::size_t at = 0; at < watts_.size();) {
      const double on_s = uniform(480, 900);
      add(at, on_s, power_w);
      at += samples(on_s + uniform(480, 900));
    }
  }

  void draw_sun(double pv_w) {
    double cloud = 1;
    double wanted = 1;
    double left_s = 0;
    for (std::size_t i = 0; i < watts_.size(); ++i) {
      const double hour = std::fmod(static_cast<double>(i) * kSampleS / 3'600, 24);
      const double height = std::max(std::sin((hour - 6) / 12 * 3.14159), 0.0);
      if ((left_s -= kSampleS) <= 0) {
        left_s = uniform(10, 400);
        wanted = uniform(0.15, 1);
      }
      cloud += (wanted - cloud) * 0.2;
      watts_[i] -= static_cast<float>(hour > 6 && hour < 18 ? pv_w * height * cloud : 0);
    }
  }

  std::int64_t start_utc_s_;
  std::mt19937_64 random_;
  std::vector<float> watts_;
};

inline constexpr MovingHouse::Habits kMovingHouses[] = {
    {.name = "quiet"},
    {.name = "kitchen", .kitchen = true},
    {.name = "car 3.7 kW", .kitchen = true, .ev_w = 3'700},
    {.name = "car 11 kW", .kitchen = true, .ev_w = 11'000},
    {.name = "heat pump", .kitchen = true, .heat_pump_w = 2'500},
    {.name = "hob", .kitchen = true, .hob = true},
    {.name = "sun 6 kW", .kitchen = true, .pv_w = 6'000},
    {.name = "all of it",
     .kitchen = true,
     .ev_w = 7'400,
     .heat_pump_w = 2'500,
     .hob = true,
     .pv_w = 6'000},
};

}  // namespace bess
