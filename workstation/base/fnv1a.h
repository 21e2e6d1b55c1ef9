// FNV-1a, 64 bits, of a text: for a name or a draw that must stay the same on every machine. No
// proof that two texts are the same.
#pragma once

#include <cstdint>
#include <string_view>

namespace bess {

inline std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

}  // namespace bess
