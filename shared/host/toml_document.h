// A TOML text as a tree of plain values, each with the place where it was written. toml++ itself is
// known to toml_document.cpp alone: it takes ten seconds to compile.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace bess {

struct TomlValue;
using TomlArray = std::vector<TomlValue>;
using TomlMembers = std::map<std::string, TomlValue, std::less<>>;

struct TomlValue {
  /// monostate: a date or a time, which nothing here reads.
  std::variant<std::monostate, bool, std::int64_t, double, std::string, TomlArray, TomlMembers>
      held;
  std::shared_ptr<const std::string> file;  ///< null in a document that was never parsed
  int line = 0;                             ///< counted from 1

  /// What is held, when it is a T; else null.
  template <typename T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(&held);
  }
  template <typename T>
  [[nodiscard]] T* as() {
    return std::get_if<T>(&held);
  }
  /// 4 as well as 4.0.
  [[nodiscard]] std::optional<double> number() const;
  /// Of a table; null when it has no such key, or when this is no table.
  [[nodiscard]] const TomlValue* find(std::string_view key) const;
};

/// No configuration and no register map comes near: a larger file is a mistake, and is not read to
/// its end.
inline constexpr std::size_t kTomlBytesMax = 256 * 1024;

/// Parses a text; false with `error` set ("name:line: message") when it is not TOML.
bool parse_toml_text(std::string_view text, const std::string& name, TomlValue& document,
                     std::string& error);

/// The same from a file; false also when it cannot be read.
bool parse_toml_file(const std::string& path, TomlValue& document, std::string& error);

}  // namespace bess
