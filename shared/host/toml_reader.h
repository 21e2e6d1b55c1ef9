// Strict reading of a TOML table: an unknown key, wrong type or out-of-range value gives one line
// with file, line and remedy. Start-up only: loaded values are in fixed-size structs. Throws
// nothing; the first error is kept and later reads are harmless.
#pragma once

#include <concepts>
#include <cstdint>
#include <set>
#include <span>
#include <string>
#include <string_view>

#include "shared/fixed_text.h"
#include "shared/host/toml_document.h"

namespace bess {

/// One table of a file. Read every allowed key before `finish`.
class TomlTable {
 public:
  /// `table` may be null or not a table: absent, all values keep their defaults. `where`: name in
  /// messages, e.g. "[battery]". Table and `error` outlive this object.
  TomlTable(const TomlValue* table, std::string file, std::string where, std::string& error)
      : table_(table != nullptr && table->as<TomlMembers>() != nullptr ? table : nullptr),
        file_(std::move(file)),
        where_(std::move(where)),
        error_(error) {}

  [[nodiscard]] bool has(std::string_view key) const { return find(key) != nullptr; }
  [[nodiscard]] const TomlValue* value() const { return table_; }
  [[nodiscard]] const std::string& file() const { return file_; }
  [[nodiscard]] const std::string& where() const { return where_; }
  [[nodiscard]] std::string& error() { return error_; }
  [[nodiscard]] bool ok() const { return error_.empty(); }

  // Readers do not change `value` if the key is absent; with `require` this is an error.
  void require(std::string_view key);
  void boolean(std::string_view key, bool& value);
  void integer(std::string_view key, std::int64_t& value, std::int64_t min, std::int64_t max);
  template <std::integral T>
  void integer(std::string_view key, T& value, std::int64_t min, std::int64_t max) {
    auto wide = static_cast<std::int64_t>(value);
    integer(key, wide, min, max);
    value = static_cast<T>(wide);
  }
  /// A decimal number times `scale`, rounded: 0.05 with scale 10000 becomes 500.
  void scaled(std::string_view key, std::int32_t& value, double scale, double min, double max);
  void number(std::string_view key, double& value, double min, double max);
  template <int kCapacity>
  void text(std::string_view key, FixedText<kCapacity>& value) {
    const std::string* found = text(key);
    if (found == nullptr || value.assign(*found)) return;
    fail(key, "is too long (at most " + std::to_string(kCapacity) + " characters)");
  }
  /// Index of the text in `choices`.
  void choice(std::string_view key, int& index, std::span<const std::string_view> choices);
  /// Enumerator, or false or true, at that index.
  template <typename Value>
  void choice(std::string_view key, Value& value, std::initializer_list<std::string_view> choices) {
    int index = static_cast<int>(value);
    choice(key, index, std::span(choices.begin(), choices.size()));
    value = static_cast<Value>(index);
  }
  /// Value of the key; null if absent, or of another type, which is an error.
  const std::string* text(std::string_view key);
  /// Text without control characters.
  void line(std::string_view key, std::string& value);
  const TomlValue* table(std::string_view key);
  /// Reader of the table at the key, "[key]" in messages.
  TomlTable child(std::string_view key) {
    return {table(key), file_, std::string("[").append(key).append("]"), error_};
  }
  const TomlArray* array(std::string_view key);
  const TomlValue* node(std::string_view key);

  /// Path relative to the folder of the file; absolute paths are unchanged.
  [[nodiscard]] std::string resolved(std::string_view path) const;

  /// Accepts a key of earlier versions, without suggesting it. True if the table has it.
  bool take_retired(std::string_view key);
  /// Reports a key that was not read.
  void finish();
  /// Records "file:line: where key message", once.
  void fail(std::string_view key, std::string_view message);
  void fail_at(const TomlValue& value, std::string_view message);

 private:
  [[nodiscard]] const TomlValue* find(std::string_view key) const {
    return table_ == nullptr ? nullptr : table_->find(key);
  }
  template <typename T>
  const T* expect(std::string_view key, std::string_view message);

  const TomlValue* table_;  ///< null: absent
  std::string file_;
  std::string where_;
  std::string& error_;
  std::set<std::string, std::less<>> asked_, retired_;
};

}  // namespace bess
