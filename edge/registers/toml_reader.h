// Strict reading of TOML: unknown key, wrong type or out-of-range value becomes one line with file,
// line and the mend. Start-up only: after loading, everything lives in fixed-size structs.
// Exceptions are off; the first error wins and later reads are harmless.
#pragma once

#define TOML_EXCEPTIONS 0
#define TOML_HEADER_ONLY 1
// toml++ 3.3 asserts, and in release builds assumes, that a table header starts with a key: "[=]"
// in a user's file breaks it. The branch after it reports the error well; so let it be reached.
#include <toml++/impl/preprocessor.h>
#undef TOML_ASSERT_ASSUME
#define TOML_ASSERT_ASSUME(expr) static_cast<void>(0)
#include <toml++/toml.h>

#include <cstdint>
#include <set>
#include <string>
#include <string_view>

#include "shared/fixed_text.h"

namespace bess {

/// One table of a file. Every key that the file may hold must be asked for before `finish`.
class TomlTable {
 public:
  /// `where` is the table's name in messages, e.g. "[battery]"; `error` outlives this object.
  TomlTable(const toml::table* table, std::string file, std::string where, std::string& error)
      : table_(table), file_(std::move(file)), where_(std::move(where)), error_(error) {}

  [[nodiscard]] bool has(std::string_view key) const;
  [[nodiscard]] const toml::table* native() const { return table_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] std::string& error() { return error_; }
  [[nodiscard]] bool ok() const { return error_.empty(); }

  // Each reader leaves `value` as it is when the key is absent; `require` makes absence an error.
  void require(std::string_view key);
  void boolean(std::string_view key, bool& value);
  void integer(std::string_view key, std::int64_t& value, std::int64_t min, std::int64_t max);
  void integer(std::string_view key, std::int32_t& value, std::int64_t min, std::int64_t max);
  /// A decimal number times `scale`, rounded: 0.05 with scale 10000 becomes 500.
  void scaled(std::string_view key, std::int32_t& value, double scale, double min, double max);
  template <int kCapacity>
  void text(std::string_view key, FixedText<kCapacity>& value) {
    std::string_view found;
    if (!find_text(key, found)) return;
    if (!value.assign(found)) {
      fail(key, "is too long (at most " + std::to_string(kCapacity) + " characters)");
    }
  }
  /// Index of the key's text in `choices`.
  void choice(std::string_view key, int& index, std::initializer_list<std::string_view> choices);
  /// A sub-table or array; null when absent.
  const toml::table* table(std::string_view key);
  const toml::array* array(std::string_view key);
  const toml::node* node(std::string_view key);

  /// Complains about every key that was not asked for.
  void finish();
  /// Records "file:line: where key message", once.
  void fail(std::string_view key, std::string_view message);
  void fail_at(const toml::node& node, std::string_view message);

 private:
  bool find_text(std::string_view key, std::string_view& value);
  template <typename T>
  const toml::value<T>* find(std::string_view key, std::string_view type_name);

  const toml::table* table_;  ///< null: the table is absent, all values keep their defaults
  std::string file_;
  std::string where_;
  std::string& error_;
  std::set<std::string, std::less<>> asked_;
};

/// Parses a file; false with `error` set ("file:line: message") when missing or not TOML.
bool parse_toml_file(const std::string& path, toml::table& document, std::string& error);

}  // namespace bess
