// Random numbers that are the same on every machine: std::mt19937_64 is fixed by the standard, the
// distributions of <random> are not, so they are written here.
#pragma once

#include <cstdint>
#include <random>

namespace bess {

class RandomSource {
 public:
  explicit RandomSource(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  /// Standard normal (Marsaglia and Bray 1964, polar method).
  double normal();

 private:
  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// First-order autoregressive process with unit variance and the given lag-1 correlation.
class UnitAutoregression {
 public:
  explicit UnitAutoregression(double correlation) : correlation_(correlation) {}
  double next(RandomSource& random);

 private:
  double correlation_;
  double value_ = 0;
  bool started_ = false;
};

}  // namespace bess
