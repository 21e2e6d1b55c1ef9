// TOML document: tree of plain values with their lines. Only toml_document.cpp includes toml++,
// which takes 10 s to compile.
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
  /// monostate: date or time, which are not used.
  std::variant<std::monostate, bool, std::int64_t, double, std::string, TomlArray, TomlMembers>
      held;
  std::shared_ptr<const std::string> file;  ///< null in a document that was not parsed
  int line = 0;                             ///< counted from 1

  /// Value if it is a T; else null.
  template <typename T>
  [[nodiscard]] const T* as() const {
    return std::get_if<T>(&held);
  }
  template <typename T>
  [[nodiscard]] T* as() {
    return std::get_if<T>(&held);
  }
  /// From 4 or 4.0.
  [[nodiscard]] std::optional<double> number() const;
  /// Member of a table; null if missing, or not a table.
  [[nodiscard]] const TomlValue* find(std::string_view key) const;
};

/// Larger than any configuration or register map; larger files are not read to their end.
inline constexpr std::size_t kTomlBytesMax = 256 * 1024;

/// Parses a text; false with `error` ("name:line: message") if it is not TOML.
bool parse_toml_text(std::string_view text, const std::string& name, TomlValue& document,
                     std::string& error);

/// The same for a file; also false if it cannot be read.
bool parse_toml_file(const std::string& path, TomlValue& document, std::string& error);

}  // namespace bess
