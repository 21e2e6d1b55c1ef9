// CRC-32 (IEEE 802.3, reflected 0xEDB88320): integrity of weights, records and checkpoints.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace bess {

namespace detail {
constexpr std::array<std::uint32_t, 256> make_crc32_table() {
  std::array<std::uint32_t, 256> table{};
  for (std::uint32_t i = 0; i < 256; ++i) {
    std::uint32_t c = i;
    for (int bit = 0; bit < 8; ++bit) c = (c & 1) != 0 ? 0xEDB88320u ^ (c >> 1) : c >> 1;
    table[i] = c;
  }
  return table;
}
inline constexpr auto kCrc32Table = make_crc32_table();
}  // namespace detail

class Crc32 {
 public:
  constexpr void add_byte(std::uint8_t byte) {
    state_ = detail::kCrc32Table[(state_ ^ byte) & 0xFFu] ^ (state_ >> 8);
  }
  /// Adds an integer as little-endian bytes, independent of the byte order of the machine.
  template <typename T>
  constexpr void add_integer(T value) {
    const auto bits = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    for (std::size_t i = 0; i < sizeof(T); ++i) {
      add_byte(static_cast<std::uint8_t>(bits >> (8 * i)));
    }
  }
  void add_bytes(const void* data, std::size_t size) {
    const auto* bytes = static_cast<const std::uint8_t*>(data);
    for (std::size_t i = 0; i < size; ++i) add_byte(bytes[i]);
  }
  [[nodiscard]] constexpr std::uint32_t value() const { return ~state_; }

 private:
  std::uint32_t state_ = 0xFFFFFFFFu;
};

inline std::uint32_t crc32_of(const void* data, std::size_t size) {
  Crc32 crc;
  crc.add_bytes(data, size);
  return crc.value();
}

}  // namespace bess
