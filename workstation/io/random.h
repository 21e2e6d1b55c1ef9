// Random numbers that repeat on every machine: splitmix64 with hand-written distributions (those of
// the standard library differ between implementations). Every use starts from a named seed.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

namespace bess {

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() {  // Steele, Lea, Flood 2014
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t z = state_;
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
    z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
    return z ^ (z >> 31);
  }
  /// Uniform in [0, 1).
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }
  /// Uniform in 0 .. count-1 (bias below 2^-32 for the counts used here).
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>((static_cast<Wide>(next()) * count) >> 64);
  }
  /// Standard normal, Box and Muller 1958.
  double normal() {
    const double radius = std::sqrt(-2 * std::log(1 - uniform()));
    return radius * std::cos(2 * std::numbers::pi * uniform());
  }
  [[nodiscard]] std::uint64_t state() const { return state_; }

 private:
  __extension__ using Wide = unsigned __int128;
  std::uint64_t state_;
};

/// A seed of its own for each named purpose of one run.
constexpr std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t purpose) {
  return (seed + 1) * 0xD1342543DE82EF95ULL + purpose * 0x2545F4914F6CDD1DULL;
}

}  // namespace bess
