// Signature of a series of integers: FNV-1a, 64 bits, equal on every machine.
#pragma once

#include <cstdint>
#include <initializer_list>

namespace bess {

class Signature {
 public:
  void add(std::int64_t value) {
    constexpr std::uint64_t kPrime = 0x100000001b3;
    for (int byte = 0; byte < 8; ++byte) {
      hash_ = (hash_ ^ ((static_cast<std::uint64_t>(value) >> (8 * byte)) & 0xff)) * kPrime;
    }
  }
  void add(std::initializer_list<std::int64_t> values) {
    for (const std::int64_t value : values) add(value);
  }
  [[nodiscard]] std::uint64_t value() const { return hash_; }

 private:
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace bess
