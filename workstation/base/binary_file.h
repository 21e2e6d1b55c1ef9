// Binary files: fixed-width little-endian fields after magic and version, then the CRC-32 of all
// preceding bytes. Files are replaced atomically and checked in full before use. Also the FNV-1a
// hash of a text.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "shared/host/user_error.h"

namespace bess {

// FNV-1a hash (64 bits) of a text, for names and draws that must be equal on every machine. Not
// collision-resistant.

inline std::uint64_t fnv1a(std::string_view text) {
  std::uint64_t hash = 0xcbf29ce484222325ULL;
  for (const char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3ULL;
  return hash;
}

static_assert(std::endian::native == std::endian::little);

class BinaryWriter {
 public:
  BinaryWriter(std::string_view magic, std::uint32_t version) {
    bytes_.append(magic);
    put(version);
  }
  template <typename T>
  void put(const T& value) {
    static_assert(std::is_trivially_copyable_v<T>);
    put_bytes(&value, sizeof value);
  }
  void put_bytes(const void* data, std::size_t size) {
    bytes_.append(static_cast<const char*>(data), size);
  }
  void put_text(std::string_view text) {
    put(static_cast<std::uint32_t>(text.size()));
    bytes_.append(text);
  }
  /// Preceded by the length; for element types without padding.
  template <typename T>
  void put_list(const std::vector<T>& list) {
    put(static_cast<std::uint64_t>(list.size()));
    put_bytes(list.data(), sizeof(T) * list.size());
  }
  /// Adds the checksum and writes the file.
  void save(const std::filesystem::path& path);

 private:
  std::string bytes_;
};

class BinaryReader {
 public:
  /// Reads the whole file and checks magic, version (`version`, or `version_min` to `version` if
  /// given) and checksum. Messages contain `kind` ("teacher file") and the remedy `remedy` ("train
  /// again").
  BinaryReader(const std::filesystem::path& path, std::string_view magic, std::uint32_t version,
               std::string_view kind, std::string_view remedy, std::uint32_t version_min = 0);
  [[nodiscard]] std::uint32_t version() const { return version_; }

  template <typename T>
  T take() {
    static_assert(std::is_trivially_copyable_v<T>);
    T value;
    take_bytes(&value, sizeof value);
    return value;
  }
  void take_bytes(void* data, std::size_t size) {
    if (size > rest_.size()) damaged("is truncated");
    std::memcpy(data, rest_.data(), size);
    rest_.remove_prefix(size);
  }
  std::string take_text() {
    const auto size = take<std::uint32_t>();
    if (size > rest_.size()) damaged("is truncated");
    std::string text(rest_.substr(0, size));
    rest_.remove_prefix(size);
    return text;
  }
  template <typename T>
  std::vector<T> take_list() {
    const auto count = take<std::uint64_t>();
    if (count > rest_.size() / sizeof(T)) damaged("is truncated");
    std::vector<T> list(count);
    take_bytes(list.data(), sizeof(T) * list.size());
    return list;
  }
  /// Throws UserError unless everything was taken.
  void finish() const {
    if (!rest_.empty()) damaged("has trailing bytes");
  }
  [[nodiscard]] const std::string& name() const { return name_; }
  /// Throws "FILE: KIND WHAT; REMEDY".
  [[noreturn]] void damaged(std::string_view what) const {
    fail("{}: {} {}; {}", name_, kind_, what, remedy_);
  }

 private:
  std::string name_, kind_, remedy_;
  std::uint32_t version_ = 0;
  std::string bytes_;
  std::string_view rest_;
};

}  // namespace bess
