// Random numbers that are equal on every machine. The standard fixes std::mt19937_64 but not the
// distributions of <random>, so they are implemented here. Every use starts from a named seed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <string>

namespace bess {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1), 53 bits.
  double uniform() { return static_cast<double>(engine_() >> 11) * 0x1.0p-53; }
  /// Uniform in 0 .. count-1 (bias below 2^-32 for the counts used here). Precondition: count > 0.
  std::size_t index(std::size_t count) {
    return static_cast<std::size_t>(high_product(engine_(), count));
  }
  /// Full state as text, to save and restore; false if the text is not a state.
  [[nodiscard]] std::string state() const;
  [[nodiscard]] bool restore(const std::string& state);

  /// Standard normal (Marsaglia and Bray 1964, polar method).
  double normal();

 private:
  /// The upper 64 of the 128 bits of a product.
  static constexpr std::uint64_t high_product(std::uint64_t a, std::uint64_t b) {
#ifdef __SIZEOF_INT128__
    __extension__ using Wide = unsigned __int128;
    return static_cast<std::uint64_t>((static_cast<Wide>(a) * b) >> 64);
#else  // 32-bit ARM (tests)
    constexpr std::uint64_t kLow = 0xffffffffU;
    const std::uint64_t low = (a & kLow) * (b & kLow);
    const std::uint64_t cross = (a >> 32) * (b & kLow) + (low >> 32);
    const std::uint64_t middle = (a & kLow) * (b >> 32) + (cross & kLow);
    return (a >> 32) * (b >> 32) + (cross >> 32) + (middle >> 32);
#endif
  }

  std::mt19937_64 engine_;
  double spare_ = 0;
  bool has_spare_ = false;
};

/// Separate seed for each named purpose of a run.
constexpr std::uint64_t derive_seed(std::uint64_t seed, std::uint64_t purpose) {
  return (seed + 1) * 0xD1342543DE82EF95ULL + purpose * 0x2545F4914F6CDD1DULL;
}

}  // namespace bess
